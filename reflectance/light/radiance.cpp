// L_r of one source: f and L together, in the coordinates that the harder of the two asks for.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/integral/gauss_legendre.h"
#include "reflectance/integral/meridian.h"
#include "reflectance/integral/refinement.h"
#include "reflectance/light/adaptive_sky.h"
#include "reflectance/light/lit_integral_parts.h"
#include "reflectance/light/polar_cell.h"

namespace gonio::reflectance {
namespace {

using OfDirection = std::function<double(const Direction&)>;

constexpr int kFirstCellLevel = 2;
constexpr int kLastCellLevel = 6;
constexpr int kFirstDiskLevel = 1;
constexpr int kLastDiskLevel = 8;

// The direction of light about which f into r has its kink or peak.
std::optional<Direction> hard_point(const Surface& leaf, const Direction& r) {
  switch (leaf.feature()) {
    case Feature::HotSpot:
      return r;
    case Feature::Lobe:
      return mirrored(r);
    case Feature::Smooth:
      break;
  }
  return std::nullopt;
}

Integral over_cells(const std::vector<PolarCell>& cells, const OfDirection& h, double tolerance) {
  return refined(kFirstCellLevel, kLastCellLevel, tolerance, [&](int level) {
    RuleSum sum;
    for (const PolarCell& cell : cells) cell.add_to(sum, h, level);
    return sum;
  });
}

// A whole disk that holds nothing hard: Gauss along the radius, even steps around.
Integral over_smooth_disk(const SunPlace& place, const OfDirection& h, double tolerance) {
  const Direction centre = Direction::from_angles(place.theta, place.phi);
  return refined(kFirstDiskLevel, kLastDiskLevel, tolerance, [&](int level) {
    const UnitRule radial = gauss_legendre(1 << level);
    const int around = 4 << level;
    RuleSum sum;
    for (int j = 0; j < around; ++j) {
      const double psi = 2.0 * std::numbers::pi * (j + 0.5) / around;
      const Meridian meridian(centre, std::cos(psi), std::sin(psi));
      for (std::size_t k = 0; k < radial.nodes.size(); ++k) {
        const double xi = place.radius.si() * radial.nodes[k];
        const Direction i = meridian.at(xi, meridian.length() - xi);
        const double step = radial.weights[k] * place.radius.si() * 2.0 * std::numbers::pi / around;
        sum.add(step * std::sin(xi) * i.mu() * h(i));
      }
    }
    return sum;
  });
}

// The middle of what the horizon leaves of a disk.
Direction middle_above_horizon(const SunPlace& place) {
  const double top = 0.5 * std::numbers::pi - place.theta.si() + place.radius.si();
  return Direction::from_elevation(radians(0.5 * std::min(top, 2.0 * place.radius.si())), place.phi);
}

Integral from_disk(const SunDisk& disk, const std::optional<Direction>& hard, const OfDirection& f, double tolerance) {
  const SunPlace& place = disk.place();
  const OfDirection h = [&](const Direction& i) { return disk.radiance() * f(i); };
  const bool holds_hard = hard && disk.covers(*hard) && hard->mu() > 0.0;
  if (!holds_hard && !disk.is_cut()) return over_smooth_disk(place, h, tolerance);
  PolarCell cell(holds_hard ? *hard : middle_above_horizon(place));
  cell.keep_within(place.theta, place.phi, place.radius);
  return over_cells({cell}, h, tolerance);
}

// Two hard points: each about itself, within its half of the sky.
Integral about_both(const Direction& a, const Direction& b, const OfDirection& h, double tolerance) {
  constexpr double kSame = 1e-6;  // [rad] closer points are one to any light or surface
  PolarCell about_a(a);
  if (phase_angle(a, b).si() < kSame) return over_cells({about_a}, h, tolerance);
  PolarCell about_b(b);
  about_a.keep_nearer_than(b);
  about_b.keep_nearer_than(a);
  return over_cells({about_a, about_b}, h, tolerance);
}

// f(i, r) L(i) as a BRDF of its own with r for the incidence: what rho_dh does for f, it does for the product.
struct Lit {
  Surface surface;
  Sky sky;
  Watch* watch;

  [[nodiscard]] Brdf eval(const Direction& r, const Direction& i) const {
    return per_steradian(watch->brdf(surface, i, r) * watch->radiance(sky, i));
  }
  [[nodiscard]] std::string_view model() const { return surface.model(); }
  [[nodiscard]] Parameters parameters() const { return surface.parameters(); }
  [[nodiscard]] bool is_isotropic() const { return surface.is_isotropic() && sky.is_zonal(); }
  [[nodiscard]] Feature feature() const { return surface.feature(); }
};

Integral from_sky(const Sky& sky, const Direction& r, const Surface& leaf, double tolerance, Watch& watch) {
  const std::optional<Direction> hard = hard_point(leaf, r);
  const OfDirection h = [&](const Direction& i) { return watch.brdf(leaf, i, r) * watch.radiance(sky, i); };
  if (!sky.theta_breaks().empty() || !sky.phi_breaks().empty()) return integrate_cells(sky, hard, h, tolerance);
  if (const std::optional<Direction> peak = sky.peak()) return about_both(*peak, hard.value_or(*peak), h, tolerance);
  return rho_dh(Lit{.surface = leaf, .sky = sky, .watch = &watch}, r, tolerance);
}

}  // namespace

Integral radiance_towards(const Direction& r, const Surface& leaf, const LightSource& source, double relative_tolerance,
                          Watch& watch) {
  if (const auto* beam = std::get_if<Beam>(&source)) {
    return Integral{
        .value = beam->irradiance() * watch.brdf(leaf, beam->direction(), r), .error = 0.0, .evaluations = 1};
  }
  if (const auto* disk = std::get_if<SunDisk>(&source)) {
    const OfDirection f = [&](const Direction& i) { return watch.brdf(leaf, i, r); };
    return from_disk(*disk, hard_point(leaf, r), f, relative_tolerance);
  }
  return from_sky(std::get<Sky>(source), r, leaf, relative_tolerance, watch);
}

}  // namespace gonio::reflectance
