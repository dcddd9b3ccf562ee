#include "reflectance/integral/polar_ladder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "reflectance/integral/gauss_legendre.h"
#include "reflectance/integral/polar_sum.h"
#include "reflectance/integral/refinement.h"

namespace gonio::reflectance {
namespace {

constexpr std::array kArcNodes{5, 8, 12, 17, 24, 34, 48};
// cot of 75 deg: closer to the horizon the meridians' ends bend too sharply for evenly spread azimuths.
constexpr double kLeastSlope = 0.27;
// A small step after a large one may be chance: of 2772 cases none used more than two thirds of
// its error by this.
constexpr double kDoubt = 0.2;
// No tolerance is wide enough to trust the first rungs.
constexpr double kWidestTolerance = 1e-4;

// Over a half turn: n even azimuths err by exp(-2 n asinh(cot theta)) of the axis.
int azimuths_for(int arc_nodes, double slope) {
  const double per_node = std::max(1.0, 0.6 / std::min(1.0, std::asinh(slope)));
  return static_cast<int>(std::ceil(arc_nodes * per_node));
}

// Gauss in the root of what is left of the arc, which tames the powers of mu at the horizon.
RuleSum rung(const PolarSum& empty, bool is_isotropic, int arc_nodes, int azimuths) {
  PolarSum sum = empty;
  const UnitRule& rule = gauss_legendre(arc_nodes);
  const int meridians = is_isotropic ? azimuths : 2 * azimuths;  // psi and -psi see the same
  const double weight = 2.0 * std::numbers::pi / meridians;
  for (int j = 0; j < meridians; ++j) {
    const double psi = std::numbers::pi * (j + 0.5) / azimuths;
    sum.set_meridian(std::cos(psi), std::sin(psi));
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
      const double root = rule.nodes[k];
      const double arc_weight = 2.0 * root * rule.weights[k] * sum.length();
      sum.add(sum.length() * ((1.0 - root) * (1.0 + root)), sum.length() * (root * root), weight * arc_weight);
    }
  }
  return sum.finished();
}

}  // namespace

PolarLadder climb_polar_ladder(const Surface& surface, const Direction& i, const Direction& axis,
                               double relative_tolerance) {
  PolarLadder ladder;
  if (axis.mu() < kLeastSlope * axis.sin_theta()) return ladder;
  const double slope = axis.mu() / std::max(axis.sin_theta(), 1e-3);
  const double tolerance = std::min(relative_tolerance, kWidestTolerance);
  double previous = 0.0;
  double last_step = 0.0;
  for (std::size_t k = 0; k < kArcNodes.size(); ++k) {
    const RuleSum fine = rung(PolarSum(surface, i, axis, tolerance), surface.is_isotropic(), kArcNodes[k],
                              azimuths_for(kArcNodes[k], slope));
    ladder.evaluations += fine.evaluations();
    const double step = std::abs(fine.value() - previous);
    previous = fine.value();
    if (k >= 2) {
      const double error = std::max(step, kDoubt * last_step) + fine.error() + kRuleRounding * fine.size();
      if (fine.size() > 0.0 && error <= tolerance * fine.size()) {
        ladder.settled = Integral{.value = fine.value(), .error = error, .evaluations = ladder.evaluations};
        return ladder;
      }
      constexpr double kLost = 1e-2;  // still of this size and not shrinking: there is a peak between the nodes
      if (step > 0.5 * last_step && step > kLost * fine.size()) return ladder;
    }
    last_step = step;
  }
  return ladder;
}

}  // namespace gonio::reflectance
