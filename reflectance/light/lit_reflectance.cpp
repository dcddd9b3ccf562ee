#include "reflectance/light/lit_reflectance.h"

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "reflectance/light/lit_integral_parts.h"
#include "reflectance/light/watch.h"
#include "reflectance/surface/lambertian.h"
#include "reflectance/surface/surface_sum.h"
#include "reflectance/surface/water_body.h"

namespace gonio::reflectance {
namespace {

constexpr double kRounding = 4e-15;  // of an f, its cosine and their product

Integral irradiance_of(const Light& light, double tolerance, Watch& watch) {
  Integral total;
  for (const LightPart& part : light.parts()) {
    if (part.weight > 0.0) total.add(irradiance_of(part.source, tolerance, watch), part.weight);
  }
  return total;
}

using OfLeaf = std::function<Integral(const Surface& leaf, const LightSource& source)>;

// All terms of a surface under all parts of a light. A Lambertian term knows only how much light there is.
Integral over_terms(const Surface& surface, const Light& light, double weight, const OfLeaf& integral_of) {
  Integral total;
  for (const SurfaceTerm& term : surface.terms()) {
    total.add(over_terms(term.surface, light, term.weight, integral_of), weight);
  }
  if (!surface.terms().empty()) return total;
  for (const LightPart& part : light.parts()) {
    if (part.weight > 0.0) total.add(integral_of(surface, part.source), weight * part.weight);
  }
  return total;
}

Integral sent_up(const Surface& surface, const Light& light, double tolerance, Watch& watch) {
  return over_terms(surface, light, 1.0, [&](const Surface& leaf, const LightSource& source) {
    if (leaf.as<Lambertian>() == nullptr) return sent_up(leaf, source, tolerance, watch);
    Integral even;
    even.add(irradiance_of(source, tolerance, watch), *leaf.closed_rho_dh(Direction()));
    return even;
  });
}

Integral smooth_radiance(const Surface& surface, const Light& light, const Direction& r, double tolerance,
                         Watch& watch) {
  return over_terms(surface, light, 1.0, [&](const Surface& leaf, const LightSource& source) {
    if (leaf.as<Lambertian>() == nullptr) return radiance_towards(r, leaf, source, tolerance, watch);
    Integral even;
    even.add(irradiance_of(source, tolerance, watch), in_per_steradian(leaf.eval(Direction(), r)));
    return even;
  });
}

Result<LitIntegral> checked(const Integral& integral, const Watch& watch) {
  if (watch.error()) return failure(*watch.error());
  return LitIntegral{.value = integral.value,
                     .error = integral.error + kRounding * std::abs(integral.value),
                     .evaluations = integral.evaluations,
                     .has_negative_brdf = watch.has_seen_negative_brdf()};
}

// Azimuths that were turned to and fro differ by some 1e-16 rad.
bool is_same(const Direction& a, const Direction& b) {
  constexpr Angle kSameWithin = radians(1e-12);
  return phase_angle(a, b) <= kSameWithin;
}

// What the mirror part sends into r: R_F L_i of the one direction that is mirrored there.
Result<double> mirrored_radiance(const Surface& surface, const Light& light, const Direction& r, Watch& watch) {
  const Direction i = mirrored(r);
  const double share = surface.specular(i);
  if (share == 0.0) return 0.0;
  double radiance = 0.0;
  for (const LightPart& part : light.parts()) {
    if (part.weight == 0.0) continue;
    if (const auto* sky = std::get_if<Sky>(&part.source)) radiance += part.weight * watch.radiance(*sky, i);
    if (const auto* disk = std::get_if<SunDisk>(&part.source); disk != nullptr && disk->covers(i)) {
      radiance += part.weight * disk->radiance();
    }
    const auto* beam = std::get_if<Beam>(&part.source);
    if (beam == nullptr || !is_same(beam->direction(), i) || beam->irradiance() == 0.0) continue;
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "find the radiance that a mirror sends up",
                    .seen = fmt::format("the image of a beam at theta {:.9g} deg, phi {:.9g} deg, where it is infinite",
                                        in_degrees(r.theta()), in_degrees(r.phi())),
                    .limit = "another direction, or a sun disk for the beam",
                    .where = InputLocation{.file = {}, .field = "r"}});
  }
  return share * radiance;
}

Error no_light(double irradiance) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "divide by the irradiance of the incident light",
          .seen = fmt::format("E_d = {}", irradiance),
          .limit = "above 0, finite",
          .where = InputLocation{.file = {}, .field = "light"}};
}

// above / E_d, with both errors.
Result<LitIntegral> per_irradiance(const Result<LitIntegral>& above, const Light& light, double tolerance) {
  if (!above) return failure(above.error());
  Result<LitIntegral> ratio = downwelling_irradiance(light, tolerance);
  if (!ratio) return ratio;
  const double irradiance = ratio->value;
  if (!(irradiance > 0.0) || !std::isfinite(irradiance)) return failure(no_light(irradiance));
  const double value = above->value / irradiance;
  ratio->error = (above->error + std::abs(value) * ratio->error) / irradiance;
  ratio->value = value;
  ratio->evaluations += above->evaluations;
  ratio->has_negative_brdf = above->has_negative_brdf;
  return ratio;
}

void gather_water(const Surface& surface, double weight, std::vector<SurfaceTerm>& water) {
  if (surface.as<WaterBody>() != nullptr) water.push_back({.surface = surface, .weight = weight});
  for (const SurfaceTerm& term : surface.terms()) gather_water(term.surface, weight * term.weight, water);
}

}  // namespace

Result<LitIntegral> downwelling_irradiance(const Light& light, double relative_tolerance) {
  Watch watch;
  return checked(irradiance_of(light, relative_tolerance, watch), watch);
}

Result<LitIntegral> upwelling_irradiance(const Surface& surface, const Light& light, double relative_tolerance) {
  Watch watch;
  return checked(sent_up(surface, light, relative_tolerance, watch), watch);
}

Result<LitIntegral> hemispherical_reflectance(const Surface& surface, const Light& light, double relative_tolerance) {
  const double half = 0.5 * relative_tolerance;
  Result<LitIntegral> r = per_irradiance(upwelling_irradiance(surface, light, half), light, half);
  if (r) r->is_above_one = r->value - r->error > 1.0;
  return r;
}

Result<LitIntegral> reflected_radiance(const Surface& surface, const Light& light, const Direction& r,
                                       double relative_tolerance) {
  Watch watch;
  Integral total = smooth_radiance(surface, light, r, relative_tolerance, watch);
  const Result<double> mirror = mirrored_radiance(surface, light, r, watch);
  if (!mirror) return failure(mirror.error());
  total.value += *mirror;
  return checked(total, watch);
}

Result<LitIntegral> remote_sensing_reflectance(const Surface& surface, const Light& light, const Direction& r,
                                               double relative_tolerance) {
  const double half = 0.5 * relative_tolerance;
  return per_irradiance(reflected_radiance(surface, light, r, half), light, half);
}

Result<Surface> water_leaving_part(const Surface& surface) {
  std::vector<SurfaceTerm> water;
  gather_water(surface, 1.0, water);
  if (water.size() == 1 && water[0].weight == 1.0) return water[0].surface;
  if (!water.empty())
    return SurfaceSum::make(std::move(water)).map([](SurfaceSum sum) { return Surface(std::move(sum)); });
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = "find what leaves the water",
                  .seen = fmt::format("the surface {}", surface.model()),
                  .limit = "a water_body, or a sum with one",
                  .where = InputLocation{.file = {}, .field = "surface"}});
}

}  // namespace gonio::reflectance
