#include "reflectance/directional_reflectance.h"

#include <cmath>
#include <optional>

#include "reflectance/polar_integral.h"

namespace gonio::reflectance {
namespace {

constexpr double kClosedForm = 2e-15;  // relative error that a model may leave in its formula

Integral smooth_part(const Surface& surface, const Direction& i, double tolerance) {
  if (const std::optional<double> closed = surface.closed_rho_dh(i)) {
    return {.value = *closed, .error = kClosedForm * std::abs(*closed)};
  }
  switch (surface.feature()) {
    case Feature::HotSpot:
      return polar_integral(surface, i, i, tolerance);
    case Feature::Lobe:
      return polar_integral(surface, i, mirrored(i), tolerance);
    case Feature::Smooth:
      break;
  }
  const auto f = [&](const Direction& r) { return in_per_steradian(surface.eval(i, r)); };
  return integrate_hemisphere(f, tolerance, RingSpacing::SqrtMu);
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
