#include "sim/optics/cone_average.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "reflectance/integral/gauss_legendre.h"
#include "sim/optics/space.h"

namespace gonio::sim {
namespace {

using reflectance::Direction;

constexpr std::array kOrders{2, 3, 4, 6, 8};

// Directions of one cone above the horizon, with their shares of its solid angle.
struct ConeNode {
  Direction direction;
  double share = 0.0;
};

std::vector<ConeNode> cone_nodes(Angle theta, Angle phi, Angle half, int order) {
  const Vector axis = unit_vector(theta, phi);
  if (half.si() == 0.0) return {{Direction::from_vector(axis), 1.0}};
  const Vector across = horizontal(phi);
  const Vector along = cross(across, axis);
  const reflectance::UnitRule& rings = reflectance::gauss_legendre(order);
  const double sin_half = std::sin(0.5 * half.si());
  const double depth = 2.0 * sin_half * sin_half;  // 1 - cos(half)
  const int turns = 4 * order;
  std::vector<ConeNode> nodes;
  for (int k = 0; k < order; ++k) {
    const double down = depth * rings.nodes[static_cast<std::size_t>(k)];
    const double out = std::sqrt(down * (2.0 - down));
    for (int j = 0; j < turns; ++j) {
      const double turn = 2.0 * std::numbers::pi * (j + 0.5 * (k % 2)) / turns;
      const Vector v = (1.0 - down) * axis + out * (std::cos(turn) * along + std::sin(turn) * across);
      if (v.z > 0.0) nodes.push_back({Direction::from_vector(v), rings.weights[static_cast<std::size_t>(k)] / turns});
    }
  }
  return nodes;
}

ConeAverage at_order(const ConeSpec& cones, const Geometry& centre, const BrdfOfDirections& f, int order) {
  const auto sources = cone_nodes(centre.theta_i, centre.phi_i, cones.source_half, order);
  const auto views = cone_nodes(centre.theta_r, centre.phi_r, cones.detector_half, order);
  double mu_i = 0.0;
  double mu_r = 0.0;
  for (const ConeNode& node : sources) mu_i += node.share * node.direction.mu();
  for (const ConeNode& node : views) mu_r += node.share * node.direction.mu();
  double sum = 0.0;
  for (const ConeNode& i : sources) {
    double seen = 0.0;
    for (const ConeNode& r : views) seen += r.share * r.direction.mu() * f(i.direction, r.direction).si();
    sum += i.share * i.direction.mu() * seen;
  }
  const int evaluations = static_cast<int>(sources.size() * views.size());
  if (evaluations == 0) return {};
  return {.brdf = per_steradian(sum / (mu_i * mu_r)), .mu_i = mu_i, .evaluations = evaluations};
}

}  // namespace

ConeAverage average_over_cones(const ConeSpec& cones, const Geometry& centre, const BrdfOfDirections& f) {
  ConeAverage last = at_order(cones, centre, f, kOrders.front());
  if (cones.source_half.si() == 0.0 && cones.detector_half.si() == 0.0) return last;
  for (std::size_t k = 1; k < kOrders.size(); ++k) {
    ConeAverage next = at_order(cones, centre, f, kOrders[k]);
    const double change = std::abs((next.brdf - last.brdf).si());
    next.evaluations += last.evaluations;
    next.error = change == 0.0 ? 0.0 : change / std::abs(next.brdf.si());
    last = next;
    if (last.error < cones.tolerance) break;
  }
  return last;
}

}  // namespace gonio::sim
