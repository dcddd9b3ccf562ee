#include "protocol/api/point_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

namespace gonio::api {

namespace {

enum Column : std::uint8_t { ThetaI, PhiI, ThetaR, PhiR, WavelengthNm, kColumns };
struct ColumnRule {
  std::string_view name;
  double least = 0.0;
  double most = 0.0;
  std::string_view unit;
  bool is_needed = false;
};
constexpr std::array<ColumnRule, kColumns> kRules{{{"theta_i_deg", 0.0, 90.0, "deg", true},
                                                   {"phi_i_deg", -360.0, 360.0, "deg", false},
                                                   {"theta_r_deg", 0.0, 90.0, "deg", true},
                                                   {"phi_r_deg", -360.0, 360.0, "deg", true},
                                                   {"wavelength_nm", 100.0, 20'000.0, "nm", false}}};

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const auto comma = line.find(',');
    cells.push_back(without_blanks(line.substr(0, comma)));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

// As it can be shown: any bytes may stand in a list.
std::string shown(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string plain(text.substr(0, kLongest));
  std::ranges::replace_if(
      plain, [](char c) { return c < ' ' || c > '~'; }, '?');
  return plain;
}

class ListReader {
 public:
  explicit ListReader(const std::string& file) { list_.file = file; }

  Result<ListShape> read(std::string_view csv) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (csv.starts_with(kByteOrderMark)) csv.remove_prefix(kByteOrderMark.size());
    while (!csv.empty()) {
      const auto end = csv.find('\n');
      const std::string_view line = without_blanks(csv.substr(0, end));
      csv.remove_prefix(end == std::string_view::npos ? csv.size() : end + 1);
      ++line_;
      if (line.empty() || line.starts_with('#')) continue;
      GONIO_TRY(columns_.empty() ? read_names(line) : read_point(line));
    }
    if (list_.points.empty()) return failure(wrong("", "a list without points", "a line of names and a point a line"));
    return std::move(list_);
  }

 private:
  [[nodiscard]] Error wrong(std::string_view field, std::string seen, std::string limit,
                            ErrorCode code = ErrorCode::InvalidInput) const {
    return {.code = code,
            .device = "plan",
            .tried = "read the list of points",
            .seen = std::move(seen),
            .limit = std::move(limit),
            .where = InputLocation{list_.file, line_, std::string(field)}};
  }

  Result<void> read_names(std::string_view line) {
    constexpr std::string_view kKnown = "theta_i_deg, theta_r_deg, phi_r_deg, phi_i_deg, wavelength_nm";
    for (const std::string_view name : cells_of(line)) {
      const auto rule = std::ranges::find(kRules, name, &ColumnRule::name);
      if (rule == kRules.end()) {
        return failure(wrong(shown(name), fmt::format("a column \"{}\"", shown(name)), std::string(kKnown),
                             ErrorCode::UnknownKey));
      }
      const auto column = static_cast<Column>(rule - kRules.begin());
      if (std::ranges::find(columns_, column) != columns_.end()) {
        return failure(wrong(name, "the column stands here twice", "each column once"));
      }
      columns_.push_back(column);
    }
    for (std::size_t k = 0; k < kRules.size(); ++k) {
      if (!kRules[k].is_needed || std::ranges::find(columns_, static_cast<Column>(k)) != columns_.end()) continue;
      return failure(wrong(kRules[k].name, "the column is missing", std::string(kKnown), ErrorCode::MissingKey));
    }
    return {};
  }

  Result<void> read_point(std::string_view line) {
    const auto cells = cells_of(line);
    if (cells.size() != columns_.size()) {
      return failure(
          wrong("", fmt::format("{} values", cells.size()), fmt::format("{}, one a column", columns_.size())));
    }
    ListedPoint point{.line = line_};
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const Column column = columns_[k];
      const auto value = number(kRules[column], cells[k]);
      if (!value) return failure(value.error());
      put(point, column, *value);
    }
    list_.points.push_back(point);
    return {};
  }

  [[nodiscard]] Result<double> number(const ColumnRule& rule, std::string_view text) const {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string limit = fmt::format("a number of {} to {} {}", rule.least, rule.most, rule.unit);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
      return failure(wrong(rule.name, fmt::format("\"{}\"", shown(text)), limit));
    }
    if (value < rule.least || value > rule.most) {
      return failure(wrong(rule.name, fmt::format("value {} {}", value, rule.unit), limit));
    }
    return value;
  }

  static void put(ListedPoint& point, Column column, double value) {
    if (column == ThetaI) point.theta_i = degrees(value);
    if (column == PhiI) point.phi_i = degrees(value);
    if (column == ThetaR) point.theta_r = degrees(value);
    if (column == PhiR) point.phi_r = degrees(value);
    if (column == WavelengthNm) point.wavelength = nanometres(value);
  }

  ListShape list_;
  std::vector<Column> columns_;
  int line_ = 0;
};

}  // namespace

Result<ListShape> parse_point_list(std::string_view csv, const std::string& file) {
  return ListReader(file).read(csv);
}

}  // namespace gonio::api
