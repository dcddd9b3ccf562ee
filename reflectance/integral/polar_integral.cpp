#include "reflectance/integral/polar_integral.h"

#include <cmath>
#include <numbers>

#include "reflectance/integral/polar_ladder.h"
#include "reflectance/integral/polar_sum.h"
#include "reflectance/integral/refinement.h"
#include "reflectance/integral/tanh_sinh.h"

namespace gonio::reflectance {
namespace {

constexpr int kFirstLevel = 2;
constexpr int kLastLevel = 6;

// psi in quarters: at grazing axes the horizon bends sharply at psi = +-90 deg, where quarters meet.
RuleSum at_level(const PolarSum& empty, bool is_isotropic, int level) {
  PolarSum sum = empty;
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  const std::vector<EndNode>& rule = tanh_sinh(level);
  const double sides = is_isotropic ? 2.0 : 1.0;  // psi and -psi see the same
  const auto add_meridian = [&](double cos_psi, double sin_psi, double weight) {
    sum.set_meridian(cos_psi, sin_psi);
    for (const EndNode& node : rule) {
      sum.add(sum.length() * node.x, sum.length() * node.rest, weight * node.weight * sum.length());
    }
  };
  for (const EndNode& node : rule) {
    const double weight = sides * node.weight * kQuarter;
    const double c = std::sin(kQuarter * node.rest);
    const double s = std::sin(kQuarter * node.x);
    add_meridian(c, s, weight);
    add_meridian(-c, s, weight);
    if (is_isotropic) continue;
    add_meridian(c, -s, weight);
    add_meridian(-c, -s, weight);
  }
  return sum.finished();
}

}  // namespace

Integral polar_integral(const Surface& surface, const Direction& i, const Direction& axis, double relative_tolerance) {
  const PolarLadder ladder = climb_polar_ladder(surface, i, axis, relative_tolerance);
  if (ladder.settled) return *ladder.settled;
  Integral integral = refined(kFirstLevel, kLastLevel, relative_tolerance, [&](int level) {
    return at_level(PolarSum(surface, i, axis, relative_tolerance), surface.is_isotropic(), level);
  });
  integral.evaluations += ladder.evaluations;
  return integral;
}

}  // namespace gonio::reflectance
