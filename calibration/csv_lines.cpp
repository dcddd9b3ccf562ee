#include "calibration/csv_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gonio::calibration {
namespace {

constexpr std::string_view kBlankCharacters = " \t\r";

std::string_view stripped(std::string_view text) {
  const auto first = text.find_first_not_of(kBlankCharacters);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlankCharacters) - first + 1);
}

std::vector<std::string_view> comma_cells(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const auto comma = line.find(',');
    cells.push_back(stripped(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

bool is_key(std::string_view text) {
  return !text.empty() &&
         std::ranges::all_of(text, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; });
}

}  // namespace

Result<CsvLines> CsvLines::read(std::string_view text, const std::string& file,
                                const std::vector<std::string_view>& known) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  CsvLines csv(file);
  while (!text.empty()) {
    const auto end = text.find('\n');
    const std::string_view line = stripped(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++csv.line_;
    if (line.empty()) continue;
    if (line.starts_with('#')) {
      csv.read_note(line.substr(1));
      continue;
    }
    GONIO_TRY(csv.names_.empty() ? csv.read_names(line, known) : csv.read_row(line));
  }
  if (!csv.rows_.empty()) return csv;
  return failure(csv.wrong(ErrorCode::InvalidInput, csv.line_, "",
                           csv.names_.empty() ? "a text without column names" : "no row below the column names",
                           fmt::format("a line of names of {}, then the rows", fmt::join(known, ", "))));
}

void CsvLines::read_note(std::string_view line) {
  const auto colon = line.find(':');
  if (colon == std::string_view::npos) return;
  const std::string_view key = stripped(line.substr(0, colon));
  if (is_key(key)) notes_.push_back({std::string(key), std::string(stripped(line.substr(colon + 1))), line_});
}

Result<void> CsvLines::read_names(std::string_view line, const std::vector<std::string_view>& known) {
  names_line_ = line_;
  for (const std::string_view name : comma_cells(line)) {
    if (std::ranges::find(known, name) == known.end()) {
      return failure(wrong(ErrorCode::UnknownKey, line_, shown_text(name),
                           fmt::format("a column \"{}\"", shown_text(name)),
                           fmt::format("{}", fmt::join(known, ", "))));
    }
    if (column(name)) {
      return failure(wrong(ErrorCode::InvalidInput, line_, name, "the column stands here twice", "each column once"));
    }
    names_.emplace_back(name);
  }
  return {};
}

Result<void> CsvLines::read_row(std::string_view line) {
  CsvRow row{.cells = comma_cells(line), .line = line_};
  if (row.cells.size() != names_.size()) {
    return failure(wrong(ErrorCode::InvalidInput, line_, "", fmt::format("{} values", row.cells.size()),
                         fmt::format("{}, one a column", names_.size())));
  }
  rows_.push_back(std::move(row));
  return {};
}

std::optional<std::size_t> CsvLines::column(std::string_view name) const {
  const auto found = std::ranges::find(names_, name);
  if (found == names_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names_.begin());
}

Result<double> CsvLines::number(std::string_view text, int line, std::string_view field) const {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && end == text.data() + text.size() && std::isfinite(value)) return value;
  return failure(wrong(ErrorCode::InvalidInput, line, field, fmt::format("\"{}\"", shown_text(text)),
                       "a number, with a point for its decimals"));
}

Error CsvLines::wrong(ErrorCode code, int line, std::string_view field, std::string seen, std::string limit) const {
  return {.code = code,
          .device = {},
          .tried = "read the reference's CSV",
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{file_, line, std::string(field)}};
}

std::string shown_text(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string plain(text.substr(0, kLongest));
  std::ranges::replace_if(
      plain, [](char c) { return c < ' ' || c > '~'; }, '?');
  return plain;
}

std::string toml_text(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += static_cast<unsigned char>(c) < 0x20U || c == 0x7F ? '?' : c;
  }
  return quoted + '"';
}

}  // namespace gonio::calibration
