#include "sim/scene/spectralon_shape.h"

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "reflectance/direction/direction.h"
#include "reflectance/integral/hemisphere_integral.h"

namespace gonio::sim {
namespace {

constexpr double kOpposition = 0.04;     // B
constexpr double kOppositionSin = 0.24;  // w: half width about 23 deg in xi
constexpr double kForward = 1.6;         // C
constexpr Angle kCertificateAngle = degrees(8.0);

// The part of the light that the lobe towards retro-reflection sends back, over B: a cubic in mu through its quadrature
// (60 x 60 Gauss nodes), 1.5e-4 off at most.
constexpr std::array kOppositionShare{0.02977, 0.10135, 0.11975, -0.04715};
// Of the forward lobe it is C sin^6(theta) times this: 1/4 in sin^6 by mu, 3/8 in sin^4 by phi.
constexpr double kForwardShare = 3.0 / 32.0;

// E(mu): the part of the light that both lobes send back.
double share_of_lobes(double mu) {
  double opposition = 0.0;
  for (auto factor = kOppositionShare.rbegin(); factor != kOppositionShare.rend(); ++factor) {
    opposition = opposition * mu + *factor;
  }
  return kOpposition * opposition + kForward * kForwardShare * std::pow(1.0 - mu * mu, 3);
}

// 2 int E mu dmu, term by term.
double mean_share_of_lobes() {
  double opposition = 0.0;
  for (std::size_t k = 0; k < kOppositionShare.size(); ++k) {
    opposition += 2.0 * kOppositionShare[k] / static_cast<double>(k + 2);
  }
  return kOpposition * opposition + 0.25 * kForward * kForwardShare;
}

double unnormalised(const Geometry& g) {
  const double sin_half_xi = std::sin(0.5 * phase_angle(g).si()) / kOppositionSin;
  const double sines = std::sin(g.theta_i.si()) * std::sin(g.theta_r.si());
  const double sin_half_phi = std::sin(0.5 * (g.phi_r - g.phi_i).si());
  const double left_by_both =
      (1.0 - share_of_lobes(std::cos(g.theta_i.si()))) * (1.0 - share_of_lobes(std::cos(g.theta_r.si())));
  return left_by_both / (1.0 - mean_share_of_lobes()) + kOpposition * std::exp(-sin_half_xi * sin_half_xi) +
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
