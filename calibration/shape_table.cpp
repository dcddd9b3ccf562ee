#include "calibration/shape_table.h"

#include <cassert>
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

double ShapeTable::value(const Geometry& g) const {
  const bool i_beyond_normal = g.theta_i < Angle{};
  const bool r_beyond_normal = g.theta_r < Angle{};
  Angle dphi = g.phi_r - g.phi_i;
  if (i_beyond_normal != r_beyond_normal) dphi += kHalfTurn;
  dphi = wrapped(dphi);
  if (dphi < Angle{}) dphi = -dphi;
  const Bracket i = bracket(theta_i_, i_beyond_normal ? -g.theta_i : g.theta_i);
  const Bracket r = bracket(theta_r_, r_beyond_normal ? -g.theta_r : g.theta_r);
  const Bracket p = bracket(phi_, dphi);
  const auto along_phi = [&](std::size_t ki, std::size_t kr) {
    const std::size_t at = (ki * theta_r_.size() + kr) * phi_.size() + p.below;
    return between(values_[at], values_[at + 1], p.fraction);
  };
  const auto along_view = [&](std::size_t ki) {
    return between(along_phi(ki, r.below), along_phi(ki, r.below + 1), r.fraction);
  };
  return between(along_view(i.below), along_view(i.below + 1), i.fraction);
}

}  // namespace gonio::calibration
