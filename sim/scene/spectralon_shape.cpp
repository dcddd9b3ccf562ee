#include "sim/scene/spectralon_shape.h"

#include <cassert>
#include <cmath>
#include <numbers>

#include "reflectance/direction/direction.h"
#include "reflectance/integral/hemisphere_integral.h"

namespace gonio::sim {
namespace {

constexpr double kLimb = 0.14;           // c: 0/70 stands 6 % below 0/0
constexpr double kOpposition = 0.04;     // B
constexpr double kOppositionSin = 0.24;  // w: half width about 23 deg in xi
constexpr double kForward = 1.4;         // C
constexpr Angle kCertificateAngle = degrees(8.0);

double limb(Angle theta) {
  const double fall = 1.0 - std::cos(theta.si());
  return 1.0 - kLimb * fall * fall;
}

double unnormalised(const Geometry& g) {
  const double sin_half_xi = std::sin(0.5 * phase_angle(g).si()) / kOppositionSin;
  const double sines = std::sin(g.theta_i.si()) * std::sin(g.theta_r.si());
  const double sin_half_phi = std::sin(0.5 * (g.phi_r - g.phi_i).si());
  return limb(g.theta_i) * limb(g.theta_r) + kOpposition * std::exp(-sin_half_xi * sin_half_xi) +
         kForward * std::pow(sines, 6) * std::pow(sin_half_phi, 4);
}

double mode_value(const ShapeMode& mode, const Geometry& g) {
  const double si = std::sin(g.theta_i.si());
  const double sr = std::sin(g.theta_r.si());
  const double dphi = (g.phi_r - g.phi_i).si();
  switch (mode.kind) {
    case ModeKind::Limb:
      return 0.5 * (std::pow(si, 4) + std::pow(sr, 4));
    case ModeKind::Forward:
      return -si * sr * std::cos(dphi);
    case ModeKind::Sideways:
      return si * si * sr * sr * std::cos(2.0 * dphi);
    case ModeKind::Opposition: {
      const double xi = phase_angle(g) / mode.width;
      return std::exp(-xi * xi);
    }
  }
  return 0.0;
}

}  // namespace

SpectralonShape::SpectralonShape() : norm_(1.0 / integral_at_8_degrees(unnormalised)) {}

double SpectralonShape::operator()(const Geometry& g) const {
  return norm_ * unnormalised(g);
}

double mode_factor(const Geometry& g, std::span<const ShapeMode> modes, std::span<const double> amplitudes) {
  assert(modes.size() == amplitudes.size());
  double factor = 1.0;
  for (std::size_t k = 0; k < modes.size(); ++k) factor += amplitudes[k] * mode_value(modes[k], g);
  return factor;
}

double integral_at_8_degrees(const std::function<double(const Geometry&)>& shape) {
  constexpr double kTolerance = 1e-7;
  const auto seen_from = [&](const reflectance::Direction& r) {
    return shape(Geometry{.theta_i = kCertificateAngle, .phi_i = {}, .theta_r = r.theta(), .phi_r = r.phi()});
  };
  return reflectance::integrate_hemisphere(seen_from, kTolerance).value / std::numbers::pi;
}

ShapeGrid shape_grid() {
  ShapeGrid grid;
  for (int k = 0; k < 12; ++k) grid.theta_deg.push_back(5.0 * k);
  for (int k = 0; k <= 12; ++k) grid.theta_deg.push_back(60.0 + 2.5 * k);
  for (int k = 0; k <= 24; ++k) grid.phi_deg.push_back(7.5 * k);
  return grid;
}

}  // namespace gonio::sim
