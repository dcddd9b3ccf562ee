#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/integral/refinement.h"
#include "reflectance/integral/tanh_sinh.h"

namespace gonio::reflectance {
namespace {

constexpr int kFirstLevel = 1;
constexpr int kLastLevel = 5;

// 2 mu rho_dh dmu by the double-exponential rule, whose ends take up the powers of mu at the horizon; all incident
// azimuths for a surface that they matter to.
RuleSum at_level(const Surface& surface, double relative_tolerance, int level) {
  const int azimuths = surface.is_isotropic() ? 1 : 4 << level;
  const std::vector<EndNode>& rule = tanh_sinh(level);
  const auto nodes = static_cast<double>(rule.size());
  RuleSum sum;
  for (const EndNode& node : rule) {
    const double mu = node.x;
    const double sin_theta = std::sqrt(node.rest * (1.0 + mu));
    const double weight = 2.0 * mu * node.weight / azimuths;
    // What counts little need not be known well: all nodes together may be a fifth of the tolerance off.
    const double share = weight * azimuths;
    const double tolerance = std::clamp(0.1 * relative_tolerance / (share * nodes), 0.1 * relative_tolerance, 1e-2);
    for (int k = 0; k < azimuths; ++k) {
      const Angle phi = radians(2.0 * std::numbers::pi * k / azimuths);
      sum.add(rho_dh(surface, Direction::from_cosine(mu, sin_theta, phi), tolerance), weight);
    }
  }
  return sum;
}

}  // namespace

Integral bond_albedo(const Surface& surface, double relative_tolerance) {
  if (const std::optional<double> closed = surface.closed_albedo()) return Integral::closed(*closed);
  if (!surface.terms().empty()) {
    Integral total;
    for (const SurfaceTerm& term : surface.terms()) {
      total.add(bond_albedo(term.surface, relative_tolerance), term.weight);
    }
    return total;
  }
  return refined(kFirstLevel, kLastLevel, relative_tolerance,
                 [&](int level) { return at_level(surface, relative_tolerance, level); });
}

}  // namespace gonio::reflectance
