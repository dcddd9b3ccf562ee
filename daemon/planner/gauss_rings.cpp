#include "daemon/planner/gauss_rings.h"

#include <cmath>
#include <numbers>

#include "reflectance/integral/gauss_legendre.h"

namespace gonio::daemon {

std::vector<GaussRing> gauss_rings(int count, Angle to) {
  const double sine = std::sin(to.si());
  const double span = sine * sine;
  const reflectance::UnitRule& rule = reflectance::gauss_legendre(count);
  std::vector<GaussRing> rings;
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    rings.push_back({radians(std::asin(std::sqrt(rule.nodes[k] * span))), std::numbers::pi * span * rule.weights[k]});
  }
  return rings;
}

}  // namespace gonio::daemon
