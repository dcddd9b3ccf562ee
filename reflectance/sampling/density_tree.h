#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "reflectance/sampling/hemisphere_chart.h"

namespace gonio::reflectance {

/// A rectangle of the chart on which a density is bilinear between its corners.
struct DensityCell {
  double v = 0.0;  ///< of the corner nearest to the origin
  double w = 0.0;
  double dv = 0.0;
  double dw = 0.0;
  std::array<double, 4> corner{};  ///< at (v, w), (v + dv, w), (v, w + dw), (v + dv, w + dw)

  [[nodiscard]] double at(ChartPoint p) const {
    const double a = (p.v - v) / dv;
    const double b = (p.w - w) / dw;
    return (1.0 - b) * ((1.0 - a) * corner[0] + a * corner[1]) + b * ((1.0 - a) * corner[2] + a * corner[3]);
  }
  [[nodiscard]] double mass() const { return 0.25 * dv * dw * (corner[0] + corner[1] + corner[2] + corner[3]); }
};

/// How a tree differs from the density it stands for, by points that played no part in making it.
struct DensityAudit {
  double integral = 0.0;         ///< of the density itself, by 16 Gauss points a cell
  double absolute = 0.0;         ///< integral of |tree - density|
  double relative_square = 0.0;  ///< integral of (tree - density)^2 / tree
  double most_ratio = 0.0;       ///< density / tree, over 24 points a cell
};

/// A density over the unit square as bilinear pieces on rectangles, halved where they are off most, in the direction in
/// which they bend most. Immutable once made; threads: any.
class DensityTree {
 public:
  /// The density, at least 0, at many points at once: values[k] at points[k].
  using Density = std::function<void(std::span<const ChartPoint> points, std::span<double> values)>;

  struct Goal {
    double accuracy = 1e-3;  ///< integral of |tree - density| over the integral of the density
    std::size_t most_cells = 65536;
    bool has_peak = false;  ///< or a kink at the origin: cells shrink towards it, however little they see of it
  };

  /// `v_origin`: where the density may have a kink or peak at w = 0, 1/2 or 1. It becomes a corner of cells. At least
  /// 512 cells.
  DensityTree(const Density& density, double v_origin, const Goal& goal);

  [[nodiscard]] std::span<const DensityCell> cells() const { return cells_; }
  [[nodiscard]] const DensityAudit& audit() const { return audit_; }
  [[nodiscard]] double mass() const { return mass_; }
  [[nodiscard]] std::uint64_t evaluations() const { return evaluations_; }
  /// The tree's density at any point of the square, in the time of a dozen comparisons.
  [[nodiscard]] double at(ChartPoint p) const;

 private:
  struct Node;
  class Builder;

  std::vector<Node> nodes_;  ///< of the search for a cell
  double v_break_ = 0.0;     ///< between the two rows of roots
  std::vector<DensityCell> cells_;
  DensityAudit audit_;
  double mass_ = 0.0;
  std::uint64_t evaluations_ = 0;
};

/// A place in the tree's search: either a cell, or a halving whose two halves follow each other.
struct DensityTree::Node {
  double middle = 0.0;
  std::uint32_t next = 0;  ///< of the lower half, or of the cell
  enum class Kind : std::uint8_t { Cell, HalvedInV, HalvedInW } kind = Kind::Cell;
};

}  // namespace gonio::reflectance
