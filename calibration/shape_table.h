#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/geometry.h"
#include "base/units.h"

namespace gonio::calibration {

/// Where a shape's rises begin and end: [0] is below, [1] above, along theta_i, theta_r and phi_r.
using ShapeSteps = std::array<std::array<Angle, 2>, 3>;

/// Along theta_i, theta_r and phi_r: a shape at the step's end less that at its beginning.
using ShapeRises = std::array<double, 3>;

/// The angular shape of an isotropic standard on a grid, linear in each of theta_i, theta_r and dphi = |phi_r - phi_i|
/// folded to [0, 180 deg] (0 towards retro-reflection, 180 deg towards specular). Beyond the last theta its edge holds.
/// A theta slightly below zero, as encoders give it about the normal, is the same direction with phi turned by 180 deg.
/// Threads: any.
class ShapeTable {
 public:
  /// Grids ascending with at least two nodes, both thetas from 0, phi from 0 to 180 deg; `values`
  /// [theta_i][theta_r][phi], phi fastest, all positive, and constant along phi wherever a theta is 0 (asserted: the
  /// reader has checked it).
  ShapeTable(std::vector<Angle> theta_i, std::vector<Angle> theta_r, std::vector<Angle> phi,
             std::vector<double> values);

  [[nodiscard]] double value(const Geometry& g) const;
  /// Along each angle with the two others as they are in g.
  [[nodiscard]] ShapeRises rises(const Geometry& g, const ShapeSteps& steps) const;
  /// How far `value` may be from a smooth shape through the same nodes: t (1 - t) h^2 / 2 times the larger second
  /// derivative that the neighbouring nodes show, summed over the axes. 0 at the nodes. In the table's unit.
  [[nodiscard]] double interpolation_error(const Geometry& g) const;

  [[nodiscard]] const std::vector<Angle>& theta_i() const { return theta_i_; }
  [[nodiscard]] const std::vector<Angle>& theta_r() const { return theta_r_; }
  [[nodiscard]] const std::vector<Angle>& phi() const { return phi_; }
  [[nodiscard]] const std::vector<double>& values() const { return values_; }

 private:
  /// theta_i, theta_r and dphi, folded.
  using Place = std::array<Angle, 3>;
  struct Bracket {
    std::size_t below = 0;
    double fraction = 0.0;  ///< of the way from `below` to the next node, in [0, 1]
  };
  using Cell = std::array<Bracket, 3>;
  /// Where to begin looking for a node, by even bins.
  class NodeFinder {
   public:
    NodeFinder() = default;
    explicit NodeFinder(const std::vector<Angle>& grid);
    [[nodiscard]] Bracket bracket(const std::vector<Angle>& grid, Angle x) const;

   private:
    static constexpr double kBins = 64;
    Angle first_;
    double bins_per_radian_ = 0.0;
    std::array<std::size_t, static_cast<std::size_t>(kBins)> below_{};
  };

  [[nodiscard]] static Place place_of(const Geometry& g);
  [[nodiscard]] Cell cell_of(const Place& place) const;
  [[nodiscard]] double value_in(const Cell& cell) const;
  [[nodiscard]] double across(const std::vector<double>& table, const Cell& cell, std::size_t axis,
                              std::size_t node) const;
  [[nodiscard]] std::vector<double> bends_along(std::size_t axis) const;
  [[nodiscard]] const std::vector<Angle>& grid(std::size_t axis) const {
    return axis == 0 ? theta_i_ : axis == 1 ? theta_r_ : phi_;
  }

  std::vector<Angle> theta_i_;
  std::vector<Angle> theta_r_;
  std::vector<Angle> phi_;
  std::vector<double> values_;
  std::array<std::size_t, 3> steps_{};  ///< from one node of an axis to the next, in `values_`
  std::array<NodeFinder, 3> finders_;
  std::array<std::vector<double>, 3> bends_;  ///< second derivatives along each axis, as `values_`
};

}  // namespace gonio::calibration
