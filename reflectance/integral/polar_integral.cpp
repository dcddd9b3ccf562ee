#include "reflectance/integral/polar_integral.h"

#include <cmath>
#include <numbers>

#include "reflectance/integral/meridian.h"
#include "reflectance/integral/refinement.h"
#include "reflectance/integral/tanh_sinh.h"

namespace gonio::reflectance {
namespace {

constexpr int kFirstLevel = 2;
constexpr int kLastLevel = 6;

// f mu sin(xi) dxi along one meridian.
void add_meridian(const Surface& surface, const Direction& i, const Meridian& meridian, double weight,
                  const std::vector<EndNode>& rule, RuleSum& sum) {
  for (const EndNode& node : rule) {
    const double xi = meridian.length() * node.x;
    const Direction r = meridian.at(xi, meridian.length() * node.rest);
    const double f = in_per_steradian(surface.eval(i, r));
    sum.add(weight * node.weight * meridian.length() * f * r.mu() * std::sin(xi));
  }
}

// psi in quarters: at grazing axes the horizon bends sharply at psi = +-90 deg, where quarters meet.
RuleSum at_level(const Surface& surface, const Direction& i, const Direction& axis, int level) {
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  const std::vector<EndNode> rule = tanh_sinh(level);
  const double sides = surface.is_isotropic() ? 2.0 : 1.0;  // psi and -psi see the same
  RuleSum sum;
  for (const EndNode& node : rule) {
    const double weight = sides * node.weight * kQuarter;
    const double c = std::sin(kQuarter * node.rest);
    const double s = std::sin(kQuarter * node.x);
    add_meridian(surface, i, Meridian(axis, c, s), weight, rule, sum);
    add_meridian(surface, i, Meridian(axis, -c, s), weight, rule, sum);
    if (surface.is_isotropic()) continue;
    add_meridian(surface, i, Meridian(axis, c, -s), weight, rule, sum);
    add_meridian(surface, i, Meridian(axis, -c, -s), weight, rule, sum);
  }
  return sum;
}

}  // namespace

Integral polar_integral(const Surface& surface, const Direction& i, const Direction& axis, double relative_tolerance) {
  return refined(kFirstLevel, kLastLevel, relative_tolerance,
                 [&](int level) { return at_level(surface, i, axis, level); });
}

}  // namespace gonio::reflectance
