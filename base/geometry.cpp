#include "base/geometry.h"

#include <cmath>
#include <numbers>

namespace gonio {

Angle wrapped(Angle a) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  if (a.si() > -std::numbers::pi && a.si() <= std::numbers::pi) return a;  // most are, and a division is slow
  const double r = std::remainder(a.si(), kTurn);                          // [-pi, pi]
  return radians(r <= -std::numbers::pi ? std::numbers::pi : r);
}

Angle phase_angle(const Geometry& g) {
  const double ti = g.theta_i.si();
  const double tr = g.theta_r.si();
  const double half_dphi = 0.5 * (g.phi_i.si() - g.phi_r.si());
  const double sines = std::sin(ti) * std::sin(tr);
  const double sin_half_phi = std::sin(half_dphi);
  const double sin_half_difference = std::sin(0.5 * (ti - tr));
  const double cos_half_sum = std::cos(0.5 * (ti + tr));
  const double cos_half_phi = std::cos(half_dphi);
  // s2 = sin^2(xi/2) and c2 = cos^2(xi/2), each a sum of squares: nothing cancels. c2 at the horizon:
  // cos^2((ti-tr)/2) - sin ti sin tr sin^2(dphi/2) = cos^2((ti+tr)/2) + sin ti sin tr cos^2(dphi/2).
  const double s2 = sin_half_difference * sin_half_difference + sines * sin_half_phi * sin_half_phi;
  const double c2 = cos_half_sum * cos_half_sum + sines * cos_half_phi * cos_half_phi;
  return radians(2.0 * std::atan2(std::sqrt(s2), std::sqrt(c2)));
}

namespace {

// The arc between two directions, by the same half-angle form.
Angle arc(Angle theta_a, Angle phi_a, Angle theta_b, Angle phi_b) {
  return phase_angle(Geometry{.theta_i = theta_a, .phi_i = phi_a, .theta_r = theta_b, .phi_r = phi_b});
}

}  // namespace

bool same_geometry(const Geometry& a, const Geometry& b, bool isotropic, Angle tolerance) {
  if (!isotropic) {
    return arc(a.theta_i, a.phi_i, b.theta_i, b.phi_i) <= tolerance &&
           arc(a.theta_r, a.phi_r, b.theta_r, b.phi_r) <= tolerance;
  }
  const double dtheta_i = std::abs(a.theta_i.si() - b.theta_i.si());
  if (dtheta_i > tolerance.si()) return false;
  const bool normal_incidence = a.theta_i <= tolerance && b.theta_i <= tolerance;
  if (normal_incidence) return std::abs(a.theta_r.si() - b.theta_r.si()) <= tolerance.si();
  return arc(a.theta_r, a.phi_r - a.phi_i, b.theta_r, b.phi_r - b.phi_i) <= tolerance;
}

}  // namespace gonio
