#include "cli/scan_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace gonio::cli {
namespace {

constexpr double kUsualCoverage = 2.0;  // of 95.45 %, with many degrees of freedom

double own_u(const api::BrdfReport& value) {
  return value.u_own_per_sr.value_or(value.u_random_per_sr.value_or(0.0));
}

ComparedPoint compared(const api::BrdfReport& a, const api::BrdfReport& b) {
  ComparedPoint point{.a = a, .b = b};
  const double u = std::hypot(own_u(a), own_u(b));
  const double k = std::max(a.k.value_or(kUsualCoverage), b.k.value_or(kUsualCoverage));
  point.difference = *b.brdf_per_sr - *a.brdf_per_sr;
  point.expanded_u = k * u;
  if (u > 0.0) {
    point.normalised_residual = point.difference / u;
    point.difference_in_u = point.normalised_residual / k;
  }
  return point;
}

}  // namespace

ScanComparison compare_values(const std::vector<api::BrdfReport>& a, const std::vector<api::BrdfReport>& b) {
  std::map<std::int64_t, const api::BrdfReport*> of_b;
  for (const api::BrdfReport& value : b) of_b[value.point] = &value;
  ScanComparison found;
  for (const api::BrdfReport& value : a) {
    const auto other = of_b.find(value.point);
    const bool both = value.brdf_per_sr && other != of_b.end() && other->second->brdf_per_sr;
    const bool one = value.brdf_per_sr || (other != of_b.end() && other->second->brdf_per_sr);
    if (!both) {
      found.without_a_value += one ? 1 : 0;
      continue;
    }
    found.points.push_back(compared(value, *other->second));
    const ComparedPoint& point = found.points.back();
    found.chi_square += point.normalised_residual * point.normalised_residual;
    const bool is_worst =
        !found.worst || std::abs(point.difference_in_u) > std::abs(found.points[*found.worst].difference_in_u);
    if (is_worst) found.worst = found.points.size() - 1;
  }
  return found;
}

bool ScanComparison::do_agree() const {
  constexpr double kSpreads = 4.0;
  const auto n = static_cast<double>(points.size());
  return chi_square <= n + kSpreads * std::sqrt(2.0 * n);
}

Table view(const ScanComparison& comparison) {
  Table table{.header = {"point", "theta_i_deg", "theta_r_deg", "phi_r_deg", "a_per_sr", "b_per_sr",
                         "difference_per_sr", "U_difference_per_sr", "difference_in_U"},
              .rows = {}};
  for (const ComparedPoint& point : comparison.points) {
    table.rows.push_back(
        {std::to_string(point.a.point), number_text(point.a.theta_i_deg), number_text(point.a.theta_r_deg),
         number_text(point.a.phi_r_deg), number_text(point.a.brdf_per_sr), number_text(point.b.brdf_per_sr),
         number_text(point.difference, 3), number_text(point.expanded_u, 3), number_text(point.difference_in_u, 3)});
  }
  return table;
}

std::string summary_of(const ScanComparison& comparison) {
  if (comparison.points.empty()) return "no point has a value in both scans";
  const ComparedPoint& worst = comparison.points[*comparison.worst];
  return fmt::format("chi-square {:.2f} for {} points{}; worst point {}: {:+.2f} U; they {}", comparison.chi_square,
                     comparison.points.size(),
                     comparison.without_a_value > 0
                         ? fmt::format(" ({} more have a value in one scan only)", comparison.without_a_value)
                         : "",
                     worst.a.point, worst.difference_in_u, comparison.do_agree() ? "agree" : "do not agree");
}

}  // namespace gonio::cli
