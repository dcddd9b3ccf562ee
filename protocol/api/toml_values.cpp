#include "protocol/api/toml_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gonio::api {

namespace {

constexpr std::size_t kLongestList = 100'000;

// {from, to, step}: both ends included; `to` must be a whole number of steps away.
std::vector<double> read_steps(TomlReader& parent, std::string_view key, NumberRange range) {
  TomlReader table = parent.table(key);
  const double from = table.number("from", range);
  const double to = table.number("to", range);
  const double step = table.number("step", {.least = 1e-6, .unit = range.unit});
  if (table.has_failed()) return {};
  if (to < from) {
    table.fail("to", ErrorCode::InvalidInput, fmt::format("value {} {}", to, range.unit),
               fmt::format("at least from = {} {}", from, range.unit));
    return {};
  }
  const double steps = (to - from) / step;
  const double whole = std::round(steps);
  if (std::abs(steps - whole) > 1e-6) {
    table.fail("step", ErrorCode::InvalidInput,
               fmt::format("{} {} are not a whole number of steps from {} to {}", step, range.unit, from, to),
               fmt::format("the last step ends at {} {}", without_creep(from + std::floor(steps) * step), range.unit));
    return {};
  }
  if (whole >= static_cast<double>(kLongestList)) {
    table.fail("step", ErrorCode::InvalidInput, fmt::format("{:.0f} values", whole + 1.0),
               fmt::format("at most {} values", kLongestList));
    return {};
  }
  std::vector<double> values;
  for (double k = 0.0; k <= whole; k += 1.0) values.push_back(without_creep(from + k * step));
  return values;
}

}  // namespace

double without_creep(double value) {
  return std::round(value * 1e9) / 1e9;
}

void refuse_repetition(TomlReader& table, std::string_view key, const std::vector<double>& values,
                       std::string_view unit) {
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
  const auto twice = std::ranges::adjacent_find(sorted);
  if (twice == sorted.end()) return;
  table.fail(key, ErrorCode::InvalidInput, fmt::format("{} {} stands here twice", *twice, unit), "each value once");
}

std::vector<double> read_values(TomlReader& table, std::string_view key, NumberRange range) {
  if (table.kind(key) == TomlKind::Table) return read_steps(table, key, range);
  std::vector<double> values = table.numbers(key, range);
  if (values.size() > kLongestList) {
    table.fail(key, ErrorCode::InvalidInput, fmt::format("{} values", values.size()),
               fmt::format("at most {} values", kLongestList));
  }
  refuse_repetition(table, key, values, range.unit);
  return values;
}

}  // namespace gonio::api
