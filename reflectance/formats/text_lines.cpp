#include "reflectance/formats/text_lines.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace gonio::formats {
namespace {

constexpr std::string_view kBlanks = " \t\r";

// As much of a text as a message can bear.
std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 40;
  return fmt::format("'{}{}'", text.substr(0, kMost), text.size() > kMost ? "..." : "");
}

}  // namespace

TextLines::TextLines(std::string_view text, std::string format, std::string file)
    : text_(text), format_(std::move(format)), file_(std::move(file)) {}

std::optional<std::string_view> TextLines::next() {
  if (at_ >= text_.size()) return std::nullopt;
  const std::size_t end = text_.find('\n', at_);
  ended_ = end != std::string_view::npos;
  std::string_view line = text_.substr(at_, ended_ ? end - at_ : std::string_view::npos);
  at_ = ended_ ? end + 1 : text_.size();
  ++line_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

std::optional<std::string_view> TextLines::next_filled(std::string_view comment_mark) {
  while (const std::optional<std::string_view> line = next()) {
    const std::string_view filled = trimmed(*line);
    if (!filled.empty() && (comment_mark.empty() || !filled.starts_with(comment_mark))) return filled;
  }
  return std::nullopt;
}

Result<void> TextLines::check_end() const {
  if (ended_) return {};
  return failure(error("", "the last line has no end, as if the file were cut off",
                       "a whole file; if it is one, end it with a new line"));
}

Error TextLines::error(std::string field, std::string seen, std::string limit) const {
  return {.code = ErrorCode::InvalidInput,
          .tried = "read it as " + format_,
          .seen = std::move(seen),
          .limit = std::move(limit),
          .where = InputLocation{file_, line_, std::move(field)}};
}

Result<double> TextLines::number(std::string_view text, std::string_view field) const {
  std::string_view digits = trimmed(text);
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_number = problem == std::errc() && end == digits.data() + digits.size() && !digits.empty();
  if (is_number && std::isfinite(value)) return value;
  return failure(error(std::string(field), shown(trimmed(text)), "a finite number"));
}

Result<std::size_t> TextLines::whole(std::string_view text, std::string_view field, std::size_t least,
                                     std::size_t most) const {
  const std::string_view digits = trimmed(text);
  std::size_t value = 0;
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool is_whole = problem == std::errc() && end == digits.data() + digits.size() && !digits.empty();
  if (is_whole && value >= least && value <= most) return value;
  return failure(error(std::string(field), shown(digits), fmt::format("a whole number, {} to {}", least, most)));
}

Result<std::vector<double>> TextLines::numbers(std::string_view text, std::string_view field, std::size_t count) const {
  const std::vector<std::string_view> parts = words(text);
  if (parts.size() != count)
    return failure(error(std::string(field), fmt::format("{} numbers", parts.size()), fmt::format("{}", count)));
  std::vector<double> values;
  values.reserve(parts.size());
  for (const std::string_view part : parts) {
    const Result<double> value = number(part, field);
    if (!value) return failure(value.error());
    values.push_back(*value);
  }
  return values;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0;;) {
    const std::size_t end = text.find(separator, at);
    parts.push_back(text.substr(at, end == std::string_view::npos ? end : end - at));
    if (end == std::string_view::npos) return parts;
    at = end + 1;
  }
}

std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t at = text.find_first_not_of(kBlanks); at != std::string_view::npos;) {
    const std::size_t end = text.find_first_of(kBlanks, at);
    parts.push_back(text.substr(at, end == std::string_view::npos ? end : end - at));
    at = end == std::string_view::npos ? end : text.find_first_not_of(kBlanks, end);
  }
  return parts;
}

KeyAndRest key_and_rest(std::string_view line) {
  const std::string_view filled = trimmed(line);
  const std::size_t end = filled.find_first_of(kBlanks);
  if (end == std::string_view::npos) return {.key = filled, .rest = {}};
  return {.key = filled.substr(0, end), .rest = trimmed(filled.substr(end))};
}

std::string number_text(double value) {
  std::array<char, 32> digits{};
  const auto [end, problem] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), end};
}

std::string one_line(std::string_view text) {
  std::string line(text);
  std::ranges::replace_if(
      line, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, ' ');
  return line;
}

}  // namespace gonio::formats
