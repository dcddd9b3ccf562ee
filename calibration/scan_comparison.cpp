#include "calibration/scan_comparison.h"

#include <cmath>
#include <map>
#include <string>
#include <utility>

namespace gonio::calibration {

ScanDifference difference_of(const CalibratedScan& a, const CalibratedPoint& in_a, const CalibratedScan& b,
                             const CalibratedPoint& in_b) {
  using Identity = std::pair<std::string, std::string>;  // owner, name
  std::map<Identity, double> common;
  double apart2 = 0.0;
  const auto add = [&](const CalibratedScan& scan, const CalibratedPoint& point, double sign) {
    apart2 += std::pow(point.budget.u_random.si(), 2);
    for (const BudgetTerm& term : point.budget.shared) {
      const Component& component = scan.components[term.component];
      const double per_sd = term.per_sd.si();
      if (&a == &b || !component.owner.empty()) {
        common[{component.owner, component.name}] += sign * per_sd;
      } else {
        apart2 += per_sd * per_sd;
      }
    }
  };
  add(a, in_a, 1.0);
  add(b, in_b, -1.0);
  double u2 = apart2;
  for (const auto& [identity, per_sd] : common) u2 += per_sd * per_sd;
  return {.value = in_a.value - in_b.value,
          .u = per_steradian(std::sqrt(u2)),
          .u_if_unknown = per_steradian(std::hypot(in_a.budget.u.si(), in_b.budget.u.si()))};
}

}  // namespace gonio::calibration
