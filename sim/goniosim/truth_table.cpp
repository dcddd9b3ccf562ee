#include "sim/goniosim/truth_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <istream>
#include <iterator>
#include <optional>
#include <vector>

#include "sim/scene/truth.h"

namespace gonio::sim {
namespace {

using Row = std::vector<std::string>;

Row split(const std::string& line) {
  Row fields(1);
  for (const char c : line) {
    if (c == ',')
      fields.emplace_back();
    else if (c != '\r' && c != '"')
      fields.back().push_back(c);
  }
  return fields;
}

/// The columns of one file, by name; errors name line and column.
class Columns {
 public:
  Columns(Row names, std::string file) : names_(std::move(names)), file_(std::move(file)) {}

  [[nodiscard]] std::optional<std::size_t> find(std::string_view name) const {
    const auto found = std::ranges::find(names_, name);
    return found == names_.end() ? std::nullopt : std::optional<std::size_t>(std::distance(names_.begin(), found));
  }

  [[nodiscard]] Result<double> number(const Row& row, std::string_view name, int line) const {
    const auto column = find(name);
    const std::string text = column && *column < row.size() ? row[*column] : std::string();
    double value = 0.0;
    const auto [end, trouble] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (trouble == std::errc() && end == text.data() + text.size()) return value;
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "read an angle or a wavelength",
                    .seen = fmt::format("found \"{}\"", text),
                    .limit = "a number",
                    .where = InputLocation{file_, line, std::string(name)}});
  }

  [[nodiscard]] Result<double> number_or(const Row& row, std::string_view name, double fallback, int line) const {
    return find(name) ? number(row, name, line) : Result<double>(fallback);
  }

  [[nodiscard]] Result<void> need(std::string_view name) const {
    if (find(name)) return {};
    return failure({.code = ErrorCode::MissingKey,
                    .tried = "read the header row",
                    .seen = "the column is missing",
                    .where = InputLocation{file_, 1, std::string(name)}});
  }

 private:
  Row names_;
  std::string file_;
};

// One row of the answer.
Result<std::string> answer(const Truth& truth, const Columns& columns, const Row& row, int line, double wavelength_nm,
                           std::size_t count) {
  std::vector<double> angles;
  for (const std::string_view name : {"theta_i_deg", "phi_i_deg", "theta_r_deg", "phi_r_deg"}) {
    auto angle = name == "phi_i_deg" ? columns.number_or(row, name, 0.0, line) : columns.number(row, name, line);
    if (!angle) return failure(std::move(angle).error());
    angles.push_back(*angle);
  }
  const auto wavelength = columns.number_or(row, "wavelength_nm", wavelength_nm, line);
  if (!wavelength) return failure(wavelength.error());
  const auto point = columns.find("point");
  const Geometry g{.theta_i = degrees(angles[0]),
                   .phi_i = degrees(angles[1]),
                   .theta_r = degrees(angles[2]),
                   .phi_r = degrees(angles[3])};
  if (std::max(std::abs(angles[0]), std::abs(angles[2])) > 90.0) {
    return failure({.code = ErrorCode::OutOfLimits,
                    .tried = fmt::format("evaluate the sample at line {}", line),
                    .seen = fmt::format("theta_i {} deg, theta_r {} deg", angles[0], angles[2]),
                    .limit = "at most 90 deg"});
  }
  return fmt::format("{},{},{},{},{},{},{:.12g}\n", point && *point < row.size() ? row[*point] : std::to_string(count),
                     angles[0], angles[1], angles[2], angles[3], *wavelength, in_per_steradian(truth.sample(g)));
}

}  // namespace

Result<std::string> truth_table(const Scene& scene, std::istream& csv, const std::string& file) {
  const Truth truth(scene);
  std::optional<Columns> columns;
  std::string out = "point,theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,wavelength_nm,brdf_per_sr\n";
  std::string text;
  std::size_t count = 0;
  for (int line = 1; std::getline(csv, text); ++line) {
    if (text.empty() || text == "\r" || text.front() == '#') continue;
    if (!columns) {
      columns.emplace(split(text), file);
      for (const std::string_view name : {"theta_i_deg", "theta_r_deg", "phi_r_deg"}) GONIO_TRY(columns->need(name));
      continue;
    }
    auto row = answer(truth, *columns, split(text), line, in_nanometres(scene.filters.front().centroid), count++);
    if (!row) return failure(std::move(row).error());
    out += *row;
  }
  return out;
}

}  // namespace gonio::sim
