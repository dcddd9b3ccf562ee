#include "sim/optics/reflected_share.h"

#include <algorithm>
#include <cmath>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/integral/hemisphere_integral.h"

namespace gonio::sim {
namespace {

constexpr int kDegrees = 90;
constexpr double kTolerance = 1e-5;

double at(const std::vector<double>& table, Angle theta) {
  const double place = std::clamp(in_degrees(theta), 0.0, static_cast<double>(kDegrees));
  const auto below = std::min(static_cast<std::size_t>(place), static_cast<std::size_t>(kDegrees - 1));
  return std::lerp(table[below], table[below + 1], place - static_cast<double>(below));
}

}  // namespace

ReflectedShare::ReflectedShare(const Scene& scene, const Truth& truth) {
  const Wavelength wavelength = scene.filters.front().centroid;
  for (int k = 0; k <= kDegrees; ++k) {
    const Angle theta_i = degrees(k);
    double share = 0.0;
    for (const auto& term : scene.sample)
      share += term.weight * reflectance::rho_dh(term.surface, theta_i, kTolerance).value;
    sample_.push_back(share);
    const auto reference = [&](const reflectance::Direction& r) {
      return truth.reference({.theta_i = theta_i, .theta_r = r.theta(), .phi_r = r.phi()}, wavelength).si();
    };
    reference_.push_back(reflectance::integrate_hemisphere(reference, kTolerance).value);
  }
}

double ReflectedShare::sample(Angle theta_i) const {
  return at(sample_, theta_i);
}

double ReflectedShare::reference(Angle theta_i) const {
  return at(reference_, theta_i);
}

}  // namespace gonio::sim
