#include "daemon/analysis/budget_summary.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "calibration/calibrated_scan.h"

namespace gonio::analysis {
namespace {

double median_of(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

// Variances of one value by kind of component.
std::map<std::string, double> variances(const daemon::BrdfRow& row, const std::vector<std::string>& names) {
  std::map<std::string, double> found{{"random", row.u_random_per_sr * row.u_random_per_sr}};
  for (std::size_t i = 0; i + 1 < row.sensitivities_per_sr.size(); i += 2) {
    const auto component = static_cast<std::size_t>(row.sensitivities_per_sr[i]);
    const double u = row.sensitivities_per_sr[i + 1];
    found[component < names.size() ? kind_of_component(names[component]) : "?"] += u * u;
  }
  return found;
}

}  // namespace

std::string kind_of_component(const std::string& name) {
  const std::string bare = name.substr(0, name.find(" ["));
  const std::size_t digit = bare.find_first_of("0123456789");
  if (digit == std::string::npos || digit == 0 || bare[digit - 1] != ' ') return bare;
  std::string kind = bare.substr(0, digit - 1);
  if (kind.ends_with(",")) return kind.substr(0, kind.size() - 1);
  return kind.ends_with("s") ? kind : kind + "s";
}

std::vector<BudgetLine> budget_summary(const daemon::BrdfInfo& brdf) {
  std::map<std::string, std::vector<double>> relative;
  std::size_t counted = 0;
  for (const daemon::BrdfRow& row : brdf.rows) {
    if (calibration::has(row.flags, calibration::PointFlag::NearZero) || row.value_per_sr == 0.0) continue;
    ++counted;
    for (const auto& [kind, variance] : variances(row, brdf.component_names)) {
      relative[kind].push_back(std::sqrt(variance) / std::abs(row.value_per_sr));
    }
  }
  std::vector<BudgetLine> lines;
  for (auto& [kind, values] : relative) {
    const double worst = std::ranges::max(values);
    values.resize(counted, 0.0);  // points that it does not concern
    lines.push_back({.name = kind, .median = median_of(values), .worst = worst});
  }
  std::ranges::sort(lines, std::ranges::greater(), &BudgetLine::median);
  return lines;
}

}  // namespace gonio::analysis
