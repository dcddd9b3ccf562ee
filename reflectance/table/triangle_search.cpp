#include "reflectance/table/triangle_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace gonio::reflectance {
namespace {

std::size_t at(std::int32_t k) {
  return static_cast<std::size_t>(k);
}

std::size_t quarter(const PlanePoint& middle, const PlanePoint& p) {
  return (p.x > middle.x ? 2U : 0U) + (p.y > middle.y ? 1U : 0U);
}

PlanePoint middle_of(const PlanePoint& middle, double half, std::size_t q) {
  return {.x = middle.x + (q >= 2 ? 0.5 : -0.5) * half, .y = middle.y + (q % 2 == 1 ? 0.5 : -0.5) * half};
}

}  // namespace

TriangleSearch::TriangleSearch(std::span<const PlanePoint> points, std::vector<MeshTriangle> triangles)
    : points_(points.begin(), points.end()), triangles_(std::move(triangles)) {
  for (const MeshTriangle& t : triangles_) {
    const PlanePoint& o = points_[at(t.corner[0])];
    const PlanePoint u{points_[at(t.corner[1])].x - o.x, points_[at(t.corner[1])].y - o.y};
    const PlanePoint v{points_[at(t.corner[2])].x - o.x, points_[at(t.corner[2])].y - o.y};
    const double area2 = u.x * v.y - u.y * v.x;
    frames_.push_back({.origin = o, .along1 = {v.y / area2, -v.x / area2}, .along2 = {-u.y / area2, u.x / area2}});
    for (std::size_t k = 0; k < 3; ++k) {
      if (t.neighbour[k] == MeshTriangle::kNone) border_.push_back({t.corner[(k + 1) % 3], t.corner[(k + 2) % 3]});
    }
  }
  cells_.emplace_back();
  split(0, PlanePoint{}, 1.0, points_, 0);
}

void TriangleSearch::split(std::size_t cell, PlanePoint middle, double half, std::vector<PlanePoint> inside,
                           int depth) {
  constexpr std::size_t kFew = 2;
  constexpr int kDeepest = 20;
  cells_[cell].triangle = walk(cells_[cell].triangle, middle).triangle;
  if (inside.size() <= kFew || depth == kDeepest) return;
  const std::int32_t hint = cells_[cell].triangle;
  const std::size_t first = cells_.size();
  cells_[cell].first_child = static_cast<std::int32_t>(first);
  cells_.resize(first + 4, Cell{.triangle = hint});
  std::array<std::vector<PlanePoint>, 4> parts;
  for (const PlanePoint& p : inside) parts[quarter(middle, p)].push_back(p);
  inside = {};
  for (std::size_t q = 0; q < 4; ++q) {
    split(first + q, middle_of(middle, half, q), 0.5 * half, std::move(parts[q]), depth + 1);
  }
}

// Across the edge that p is farthest beyond, until it is beyond none. In a Delaunay triangulation such a walk cannot go
// in circles (De Floriani et al. 1991); the bound is for rounding.
TriangleSearch::Found TriangleSearch::walk(std::int32_t start, const PlanePoint& p) const {
  constexpr double kRounding = -1e-12;
  Found found{.triangle = start, .weight = {}, .is_inside = true};
  for (std::size_t step = 0; step < 2 * triangles_.size() + 8; ++step) {
    const Frame& f = frames_[at(found.triangle)];
    const double dx = p.x - f.origin.x;
    const double dy = p.y - f.origin.y;
    const double b1 = dx * f.along1.x + dy * f.along1.y;
    const double b2 = dx * f.along2.x + dy * f.along2.y;
    found.weight = {1.0 - b1 - b2, b1, b2};
    const std::size_t k =
        static_cast<std::size_t>(std::min_element(found.weight.begin(), found.weight.end()) - found.weight.begin());
    if (found.weight[k] >= kRounding) return found;
    const std::int32_t next = triangles_[at(found.triangle)].neighbour[k];
    if (next == MeshTriangle::kNone) break;
    found.triangle = next;
  }
  found.is_inside = false;
  return found;
}

MeshPlace TriangleSearch::locate(const PlanePoint& p) const {
  std::size_t cell = 0;
  PlanePoint middle;
  double half = 1.0;
  while (cells_[cell].first_child >= 0) {
    const std::size_t q = quarter(middle, p);
    cell = at(cells_[cell].first_child) + q;
    middle = middle_of(middle, half, q);
    half *= 0.5;
  }
  const Found found = walk(cells_[cell].triangle, p);
  if (!found.is_inside) return on_border(p);
  MeshPlace place{.corner = triangles_[at(found.triangle)].corner, .weight = found.weight, .triangle = found.triangle};
  for (double& w : place.weight) w = std::max(w, 0.0);
  return place;
}

MeshPlace TriangleSearch::on_border(const PlanePoint& p) const {
  double nearest = std::numeric_limits<double>::infinity();
  MeshPlace place{.is_inside = false};
  for (const std::array<std::int32_t, 2>& edge : border_) {
    const PlanePoint& a = points_[at(edge[0])];
    const PlanePoint& b = points_[at(edge[1])];
    const double ux = b.x - a.x;
    const double uy = b.y - a.y;
    const double t = std::clamp(((p.x - a.x) * ux + (p.y - a.y) * uy) / (ux * ux + uy * uy), 0.0, 1.0);
    const double distance2 = std::pow(a.x + t * ux - p.x, 2) + std::pow(a.y + t * uy - p.y, 2);
    if (distance2 >= nearest) continue;
    nearest = distance2;
    place.corner = {edge[0], edge[1], edge[0]};
    place.weight = {1.0 - t, t, 0.0};
  }
  return place;
}

}  // namespace gonio::reflectance
