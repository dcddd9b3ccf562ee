#include "reflectance/integral/directional_reflectance.h"

#include <optional>

#include "reflectance/integral/hemisphere_integral.h"
#include "reflectance/integral/polar_integral.h"
#include "reflectance/integral/polar_ladder.h"

namespace gonio::reflectance {
namespace {

Integral smooth_part(const Surface& surface, const Direction& i, double tolerance) {
  if (const std::optional<double> closed = surface.closed_rho_dh(i)) return Integral::closed(*closed);
  if (const std::optional<Integral> own = surface.own_rho_dh(i, tolerance)) return *own;
  switch (surface.feature()) {
    case Feature::HotSpot:
      return polar_integral(surface, i, i, tolerance);
    case Feature::Lobe:
      return polar_integral(surface, i, mirrored(i), tolerance);
    case Feature::Smooth:
      break;
  }
  // Close to the horizon 1/(mu_i + mu_r) and its like bend within mu_i of it: too sharp for Gauss.
  constexpr double kGrazing = 0.03;
  if (i.mu() < kGrazing) return polar_integral(surface, i, Direction(), tolerance);
  const PolarLadder ladder = climb_polar_ladder(surface, i, Direction(), tolerance);
  if (ladder.settled) return *ladder.settled;
  const auto f = [&](const Direction& r) { return in_per_steradian(surface.eval(i, r)); };
  Integral integral = integrate_hemisphere(f, tolerance, RingSpacing::SqrtMu);
  integral.evaluations += ladder.evaluations;
  return integral;
}

// The surface with source and detector changed over.
struct Reversed {
  Surface surface;
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const { return surface.eval(r, i); }
  [[nodiscard]] double specular(const Direction& i) const { return surface.specular(mirrored(i)); }
  [[nodiscard]] std::string_view model() const { return surface.model(); }
  [[nodiscard]] Parameters parameters() const { return surface.parameters(); }
  [[nodiscard]] bool is_isotropic() const { return surface.is_isotropic(); }
  [[nodiscard]] Feature feature() const { return surface.feature(); }
};

}  // namespace

Integral rho_dh(const Surface& surface, const Direction& i, double relative_tolerance) {
  Integral total;
  if (surface.terms().empty()) {
    total = smooth_part(surface, i, relative_tolerance);
    total.add(Integral::closed(surface.specular(i)), 1.0);
    return total;
  }
  for (const SurfaceTerm& term : surface.terms()) total.add(rho_dh(term.surface, i, relative_tolerance), term.weight);
  return total;
}

Integral rho_dh(const Surface& surface, Angle theta_i, double relative_tolerance) {
  return rho_dh(surface, Direction::from_angles(theta_i, Angle{}), relative_tolerance);
}

Integral rho_hd(const Surface& surface, const Direction& r, double relative_tolerance) {
  if (surface.terms().empty()) return rho_dh(Reversed{surface}, r, relative_tolerance);
  Integral total;
  for (const SurfaceTerm& term : surface.terms()) total.add(rho_hd(term.surface, r, relative_tolerance), term.weight);
  return total;
}

}  // namespace gonio::reflectance
