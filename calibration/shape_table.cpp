#include "calibration/shape_table.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace gonio::calibration {
namespace {

struct Bracket {
  std::size_t below = 0;
  double fraction = 0.0;  ///< of the way from `below` to the next node, in [0, 1]
};

Bracket bracket(const std::vector<Angle>& grid, Angle x) {
  if (x <= grid.front()) return {0, 0.0};
  std::size_t k = 0;
  while (k + 2 < grid.size() && x > grid[k + 1]) ++k;
  const double fraction = (x - grid[k]) / (grid[k + 1] - grid[k]);
  return {k, fraction < 1.0 ? fraction : 1.0};
}

double between(double a, double b, double fraction) {
  return a + fraction * (b - a);
}

constexpr Angle kHalfTurn = radians(std::numbers::pi);

}  // namespace

ShapeTable::ShapeTable(std::vector<Angle> theta_i, std::vector<Angle> theta_r, std::vector<Angle> phi,
                       std::vector<double> values)
    : theta_i_(std::move(theta_i)), theta_r_(std::move(theta_r)), phi_(std::move(phi)), values_(std::move(values)) {
  assert(theta_i_.size() >= 2 && theta_r_.size() >= 2 && phi_.size() >= 2);
  assert(values_.size() == theta_i_.size() * theta_r_.size() * phi_.size());
}

ShapeTable::Place ShapeTable::place_of(const Geometry& g) {
  const bool i_beyond_normal = g.theta_i < Angle{};
  const bool r_beyond_normal = g.theta_r < Angle{};
  Angle dphi = g.phi_r - g.phi_i;
  if (i_beyond_normal != r_beyond_normal) dphi += kHalfTurn;
  dphi = wrapped(dphi);
  return {i_beyond_normal ? -g.theta_i : g.theta_i, r_beyond_normal ? -g.theta_r : g.theta_r,
          dphi < Angle{} ? -dphi : dphi};
}

double ShapeTable::value(const Geometry& g) const {
  return at(place_of(g));
}

double ShapeTable::at(const Place& place) const {
  const Bracket i = bracket(theta_i_, place[0]);
  const Bracket r = bracket(theta_r_, place[1]);
  const Bracket p = bracket(phi_, place[2]);
  const auto along_phi = [&](std::size_t ki, std::size_t kr) {
    const std::size_t n = (ki * theta_r_.size() + kr) * phi_.size() + p.below;
    return between(values_[n], values_[n + 1], p.fraction);
  };
  const auto along_view = [&](std::size_t ki) {
    return between(along_phi(ki, r.below), along_phi(ki, r.below + 1), r.fraction);
  };
  return between(along_view(i.below), along_view(i.below + 1), i.fraction);
}

double ShapeTable::interpolation_error(const Geometry& g) const {
  const Place place = place_of(g);
  double error = 0.0;
  for (std::size_t axis = 0; axis < place.size(); ++axis) {
    const std::vector<Angle>& nodes = grid(axis);
    const Bracket b = bracket(nodes, place[axis]);
    const auto value_at = [&](std::size_t node) {
      Place moved = place;
      moved[axis] = nodes[node];
      return at(moved);
    };
    // The second derivative about node k, from it and its two neighbours (divided differences).
    const auto curvature = [&](std::size_t k) {
      if (k == 0 || k + 1 >= nodes.size()) return 0.0;
      const double left = (nodes[k] - nodes[k - 1]).si();
      const double right = (nodes[k + 1] - nodes[k]).si();
      const double rise = (value_at(k + 1) - value_at(k)) / right - (value_at(k) - value_at(k - 1)) / left;
      return 2.0 * std::abs(rise) / (left + right);
    };
    const double h = (nodes[b.below + 1] - nodes[b.below]).si();
    error += 0.5 * b.fraction * (1.0 - b.fraction) * h * h * std::max(curvature(b.below), curvature(b.below + 1));
  }
  return error;
}

}  // namespace gonio::calibration
