#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "reflectance/table/delaunay.h"

namespace gonio::reflectance {

/// Where a point lies in a triangulation: weights that sum to 1 for the three corners.
struct MeshPlace {
  std::array<std::int32_t, 3> corner{};
  std::array<double, 3> weight{};               ///< none below 0
  std::int32_t triangle = MeshTriangle::kNone;  ///< none on the border
  bool is_inside = true;                        ///< else this is the nearest place on the border
};

/// Finds the triangle that holds a point: a quadtree, as fine as the corners are dense, gives a triangle close by, from
/// which a walk across edges ends after a step or two. Immutable; threads: any.
class TriangleSearch {
 public:
  TriangleSearch(std::span<const PlanePoint> points, std::vector<MeshTriangle> triangles);

  [[nodiscard]] MeshPlace locate(const PlanePoint& p) const;
  [[nodiscard]] std::span<const MeshTriangle> triangles() const { return triangles_; }
  /// Pairs of corners, each with the triangles on its left.
  [[nodiscard]] std::span<const std::array<std::int32_t, 2>> border() const { return border_; }
  [[nodiscard]] std::span<const PlanePoint> points() const { return points_; }

 private:
  /// Barycentric coordinates as affine functions: b1 = (p - origin).along1, b2 = (p - origin).along2.
  struct Frame {
    PlanePoint origin;
    PlanePoint along1;
    PlanePoint along2;
  };
  struct Cell {
    std::int32_t first_child = -1;  ///< of four, by x then y; -1: a leaf
    std::int32_t triangle = 0;      ///< of a leaf, at its middle or near it
  };
  struct Found {
    std::int32_t triangle;
    std::array<double, 3> weight;
    bool is_inside;
  };

  [[nodiscard]] Found walk(std::int32_t start, const PlanePoint& p) const;
  [[nodiscard]] MeshPlace on_border(const PlanePoint& p) const;
  void split(std::size_t cell, PlanePoint middle, double half, std::vector<PlanePoint> inside, int depth);

  std::vector<PlanePoint> points_;
  std::vector<MeshTriangle> triangles_;
  std::vector<Frame> frames_;
  std::vector<std::array<std::int32_t, 2>> border_;
  std::vector<Cell> cells_;
};

}  // namespace gonio::reflectance
