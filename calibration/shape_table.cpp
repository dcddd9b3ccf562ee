#include "calibration/shape_table.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace gonio::calibration {
namespace {

double between(double a, double b, double fraction) {
  return a + fraction * (b - a);
}

constexpr Angle kHalfTurn = radians(std::numbers::pi);

}  // namespace

ShapeTable::NodeFinder::NodeFinder(const std::vector<Angle>& grid)
    : first_(grid.front()), bins_per_radian_(kBins / (grid.back() - grid.front()).si()) {
  for (std::size_t bin = 0; bin < below_.size(); ++bin) {
    const Angle low = first_ + radians(static_cast<double>(bin) / bins_per_radian_);
    std::size_t k = 0;
    while (k + 2 < grid.size() && low > grid[k + 1]) ++k;
    below_[bin] = k;
  }
}

ShapeTable::Bracket ShapeTable::NodeFinder::bracket(const std::vector<Angle>& grid, Angle x) const {
  if (!(x > grid.front())) return {0, 0.0};
  const auto bin = static_cast<std::size_t>(std::min((x - first_).si() * bins_per_radian_, kBins - 1.0));
  std::size_t k = below_[bin];
  while (k > 0 && x <= grid[k]) --k;  // a bin's own edge is rounded
  while (k + 2 < grid.size() && x > grid[k + 1]) ++k;
  const double fraction = (x - grid[k]) / (grid[k + 1] - grid[k]);
  return {k, fraction < 1.0 ? fraction : 1.0};
}

ShapeTable::ShapeTable(std::vector<Angle> theta_i, std::vector<Angle> theta_r, std::vector<Angle> phi,
                       std::vector<double> values)
    : theta_i_(std::move(theta_i)), theta_r_(std::move(theta_r)), phi_(std::move(phi)), values_(std::move(values)) {
  assert(theta_i_.size() >= 2 && theta_r_.size() >= 2 && phi_.size() >= 2);
  assert(values_.size() == theta_i_.size() * theta_r_.size() * phi_.size());
  steps_ = {theta_r_.size() * phi_.size(), phi_.size(), 1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    finders_[axis] = NodeFinder(grid(axis));
    bends_[axis] = bends_along(axis);
  }
}

// At each node, from it and its two neighbours (divided differences); 0 at the first and the last.
std::vector<double> ShapeTable::bends_along(std::size_t axis) const {
  const std::vector<Angle>& nodes = grid(axis);
  const std::size_t step = steps_[axis];
  std::vector<double> bends(values_.size(), 0.0);
  for (std::size_t n = 0; n < values_.size(); ++n) {
    const std::size_t k = n / step % nodes.size();
    if (k == 0 || k + 1 == nodes.size()) continue;
    const double left = (nodes[k] - nodes[k - 1]).si();
    const double right = (nodes[k + 1] - nodes[k]).si();
    const double rise = (values_[n + step] - values_[n]) / right - (values_[n] - values_[n - step]) / left;
    bends[n] = 2.0 * rise / (left + right);
  }
  return bends;
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

ShapeTable::Cell ShapeTable::cell_of(const Place& place) const {
  Cell cell;
  for (std::size_t axis = 0; axis < place.size(); ++axis) cell[axis] = finders_[axis].bracket(grid(axis), place[axis]);
  return cell;
}

// Linear in the two other axes, at one node of this one.
double ShapeTable::across(const std::vector<double>& table, const Cell& cell, std::size_t axis,
                          std::size_t node) const {
  const std::size_t slow = axis == 0 ? 1 : 0;
  const std::size_t fast = axis == 2 ? 1 : 2;
  const std::size_t n = node * steps_[axis] + cell[slow].below * steps_[slow] + cell[fast].below * steps_[fast];
  const auto along_fast = [&](std::size_t from) {
    return between(table[from], table[from + steps_[fast]], cell[fast].fraction);
  };
  return between(along_fast(n), along_fast(n + steps_[slow]), cell[slow].fraction);
}

double ShapeTable::value_in(const Cell& cell) const {
  const auto& [i, r, phi] = cell;
  const auto at_theta_i = [&, &phi = phi, &r = r](const double* corner) {
    const double* const next = corner + steps_[1];
    return between(between(corner[0], corner[1], phi.fraction), between(next[0], next[1], phi.fraction), r.fraction);
  };
  const double* const corner = values_.data() + i.below * steps_[0] + r.below * steps_[1] + phi.below;
  return between(at_theta_i(corner), at_theta_i(corner + steps_[0]), i.fraction);
}

double ShapeTable::value(const Geometry& g) const {
  return value_in(cell_of(place_of(g)));
}

// A step changes one bracket of the cell, but where a theta goes below zero and turns phi; a theta that does not is its
// own place.
ShapeRises ShapeTable::rises(const Geometry& g, const ShapeSteps& steps) const {
  const Cell cell = cell_of(place_of(g));
  const bool is_off_pole = steps[0][0] >= Angle{} && steps[1][0] >= Angle{};
  const auto place_at = [&](std::size_t axis, Angle to) {
    Geometry at = g;
    (axis == 0 ? at.theta_i : axis == 1 ? at.theta_r : at.phi_r) = to;
    return place_of(at);
  };
  const auto moved = [&](std::size_t axis, Angle to) {
    if (!is_off_pole) return value_in(cell_of(place_at(axis, to)));
    Cell next = cell;
    next[axis] = finders_[axis].bracket(grid(axis), axis == 2 ? place_at(axis, to)[axis] : to);
    return value_in(next);
  };
  ShapeRises rises{};
  for (std::size_t axis = 0; axis < steps.size(); ++axis) {
    rises[axis] = moved(axis, steps[axis][1]) - moved(axis, steps[axis][0]);
  }
  return rises;
}

double ShapeTable::interpolation_error(const Geometry& g) const {
  const Cell cell = cell_of(place_of(g));
  double error = 0.0;
  for (std::size_t axis = 0; axis < cell.size(); ++axis) {
    const Bracket& b = cell[axis];
    const double h = (grid(axis)[b.below + 1] - grid(axis)[b.below]).si();
    const double bend = std::max(std::abs(across(bends_[axis], cell, axis, b.below)),
                                 std::abs(across(bends_[axis], cell, axis, b.below + 1)));
    error += 0.5 * b.fraction * (1.0 - b.fraction) * h * h * bend;
  }
  return error;
}

}  // namespace gonio::calibration
