#include "calibration/certificate_mean.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace gonio::calibration {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Angle kEight = degrees(8.0);
constexpr Angle kLongestCell = degrees(5.0);

// Gauss-Legendre, 8 points on [-1, 1] (Abramowitz and Stegun 1964, table 25.4).
constexpr std::array<double, 8> kNodes = {-0.960289856497536, -0.796666477413627, -0.525532409916329,
                                          -0.183434642495650, 0.183434642495650,  0.525532409916329,
                                          0.796666477413627,  0.960289856497536};
constexpr std::array<double, 8> kWeights = {0.101228536290376, 0.222381034453374, 0.313706645877887, 0.362683783378362,
                                            0.362683783378362, 0.313706645877887, 0.222381034453374, 0.101228536290376};

struct Node {
  double x = 0.0;
  double weight = 0.0;
};

std::vector<Node> gauss_in_cells(const std::vector<Angle>& breaks, Angle end) {
  std::vector<Node> nodes;
  for (std::size_t k = 0; k < breaks.size(); ++k) {
    const Angle from = breaks[k];
    const Angle to = k + 1 < breaks.size() ? breaks[k + 1] : end;
    if (to <= from) continue;
    const int parts = static_cast<int>(std::ceil((to - from) / kLongestCell));
    const double half = 0.5 * (to - from).si() / parts;
    for (int part = 0; part < parts; ++part) {
      const double middle = from.si() + (2 * part + 1) * half;
      for (std::size_t n = 0; n < kNodes.size(); ++n) nodes.push_back({middle + half * kNodes[n], half * kWeights[n]});
    }
  }
  return nodes;
}

// The geometry with the narrow direction at 8 deg, phi = 0, and the other one anywhere.
Geometry with_eight(CertificateGeometry kind, Angle theta, Angle phi) {
  if (kind == CertificateGeometry::EightHemispherical) {
    return {.theta_i = kEight, .phi_i = {}, .theta_r = theta, .phi_r = phi};
  }
  return {.theta_i = theta, .phi_i = phi, .theta_r = kEight, .phi_r = {}};
}

// The integral over the cone of half angle `port` about the mirror direction (theta = 8 deg, phi = 180 deg).
double port_integral(const std::function<double(const Geometry&)>& s, CertificateGeometry kind, Angle port) {
  constexpr int kTurnSteps = 64;
  const double sin_c = -std::sin(kEight.si());  // x of the mirror direction
  const double cos_c = std::cos(kEight.si());
  double sum = 0.0;
  for (const Node& a : gauss_in_cells({Angle{}}, port)) {
    for (int k = 0; k < kTurnSteps; ++k) {
      const double turn = 2.0 * kPi * k / kTurnSteps;
      // The axis (sin_c, 0, cos_c), across it (cos_c, 0, -sin_c) and (0, 1, 0).
      const double x = std::cos(a.x) * sin_c + std::sin(a.x) * std::cos(turn) * cos_c;
      const double y = std::sin(a.x) * std::sin(turn);
      const double z = std::cos(a.x) * cos_c - std::sin(a.x) * std::cos(turn) * sin_c;
      const Geometry g = with_eight(kind, radians(std::atan2(std::hypot(x, y), z)), radians(std::atan2(y, x)));
      sum += s(g) * z * std::sin(a.x) * a.weight * (2.0 * kPi / kTurnSteps);
    }
  }
  return sum;
}

}  // namespace

double certificate_mean(const std::function<double(const Geometry&)>& s, const ShapeTable& grid,
                        CertificateGeometry geometry, std::optional<Angle> port) {
  if (geometry == CertificateGeometry::ZeroFortyFive) return s({.theta_r = degrees(45.0)});
  const auto& theta_breaks = geometry == CertificateGeometry::EightHemispherical ? grid.theta_r() : grid.theta_i();
  const std::vector<Node> azimuths = gauss_in_cells(grid.phi(), radians(kPi));
  double sum = 0.0;
  for (const Node& theta : gauss_in_cells(theta_breaks, radians(0.5 * kPi))) {
    double ring = 0.0;
    for (const Node& phi : azimuths) ring += phi.weight * s(with_eight(geometry, radians(theta.x), radians(phi.x)));
    sum += theta.weight * std::cos(theta.x) * std::sin(theta.x) * 2.0 * ring;  // both halves of phi
  }
  if (port) sum -= port_integral(s, geometry, *port);
  return sum / kPi;
}

}  // namespace gonio::calibration
