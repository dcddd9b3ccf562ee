#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "reflectance/table/stencil.h"
#include "reflectance/table/triangle_search.h"

namespace gonio::reflectance {

/// Weight of a direction in a quadrature, dOmega [sr].
using QuadratureSink = std::function<void(const Vector& r, double solid_angle_sr)>;

/// Scattered directions of one incidence, triangulated: linear within each triangle of the stereographic plane, so that
/// no value lies outside of its three readings'. Immutable; threads: any.
class MeshRow {
 public:
  /// Errors: InvalidInput when the nodes lie on one line through the pole.
  [[nodiscard]] static Result<MeshRow> make(std::span<const TableNode> nodes);

  [[nodiscard]] Stencil locate(const Vector& r) const;
  /// The same without node k (and its mirror image, when it has one), from the nodes around it; nothing on the border.
  [[nodiscard]] std::optional<Stencil> locate_without(std::size_t k, std::optional<std::size_t> mirror_image) const;
  /// A node across a side of a triangle, as an affine sum of that triangle's corners: weights sum to 1, any sign.
  struct FarNode {
    std::size_t node = 0;
    std::array<std::size_t, 3> corner{};
    std::array<double, 3> weight{};
  };
  /// Of the triangle at r: as many as have a triangle across; none beyond the border.
  [[nodiscard]] std::vector<FarNode> across(const Vector& r) const;
  /// Hands out the nodes of a quadrature over the hemisphere whose cells are the triangles, and beyond the border the
  /// sectors between it and the horizon. False, and nothing handed out, when the readings do not surround the normal.
  [[nodiscard]] bool quadrature(int order, const QuadratureSink& sink) const;

 private:
  explicit MeshRow(TriangleSearch search);
  [[nodiscard]] std::vector<std::int32_t> around(std::size_t k) const;

  TriangleSearch search_;
  std::vector<double> width_;                     ///< the longest side of each triangle [rad]
  std::vector<std::vector<std::int32_t>> round_;  ///< the triangles at each node
  std::vector<char> is_border_;
};

}  // namespace gonio::reflectance
