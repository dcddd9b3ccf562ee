#include "reflectance/directional_reflectance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reflectance/polar_integral.h"

namespace gonio::reflectance {
namespace {

constexpr double kRounding = 4e-16;

Integral smooth_by_rings(const Surface& surface, const Direction& i, double tolerance) {
  constexpr int kFirstRings = 8;
  constexpr int kMostRings = 256;
  Integral result;
  double coarse = 0.0;
  for (int rings = kFirstRings; rings <= kMostRings; rings *= 2) {
    const std::vector<HemisphereNode> nodes = gauss_rings(rings, 2 * rings, RingSpacing::SqrtMu);
    double fine = 0.0;
    for (const HemisphereNode& node : nodes) fine += node.weight_sr * in_per_steradian(surface.eval(i, node.direction));
    result.value = fine;
    result.evaluations += nodes.size();
    result.error = std::abs(fine - coarse) + kRounding * std::abs(fine);
    if (rings > kFirstRings && result.error <= tolerance * std::abs(fine)) break;
    coarse = fine;
  }
  return result;
}

Integral smooth_part(const Surface& surface, const Direction& i, double tolerance) {
  if (const std::optional<double> closed = surface.closed_rho_dh(i)) {
    return {.value = *closed, .error = kRounding * 4.0 * std::abs(*closed)};
  }
  switch (surface.feature()) {
    case Feature::HotSpot:
      return polar_integral(surface, i, i, tolerance);
    case Feature::Lobe:
      return polar_integral(surface, i, mirrored(i), tolerance);
    case Feature::Smooth:
      break;
  }
  return smooth_by_rings(surface, i, tolerance);
}

}  // namespace

Integral rho_dh(const Surface& surface, const Direction& i, double relative_tolerance) {
  Integral total;
  if (surface.terms().empty()) {
    total = smooth_part(surface, i, relative_tolerance);
    total.value += surface.specular(i);
    return total;
  }
  for (const SurfaceTerm& term : surface.terms()) {
    const Integral part = rho_dh(term.surface, i, relative_tolerance);
    total.value += term.weight * part.value;
    total.error += term.weight * part.error;
    total.evaluations += part.evaluations;
  }
  return total;
}

Integral rho_dh(const Surface& surface, Angle theta_i, double relative_tolerance) {
  return rho_dh(surface, Direction::from_angles(theta_i, Angle{}), relative_tolerance);
}

}  // namespace gonio::reflectance
