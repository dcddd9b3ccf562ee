#include "reflectance/table/mesh_row.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "reflectance/integral/gauss_legendre.h"

namespace gonio::reflectance {
namespace {

std::size_t at(std::int32_t k) {
  return static_cast<std::size_t>(k);
}

// dOmega / dA of the plane.
double solid_angle_of_area(const PlanePoint& p) {
  const double root = 2.0 / (1.0 + p.x * p.x + p.y * p.y);
  return root * root;
}

struct Corners {
  PlanePoint a;
  PlanePoint b;
  PlanePoint c;
};

double twice_area(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Barycentric: p = sum of weight x corner, wherever p lies.
std::array<double, 3> affine_weights(const Corners& t, const PlanePoint& p) {
  const double whole = twice_area(t.a, t.b, t.c);
  return {twice_area(p, t.b, t.c) / whole, twice_area(t.a, p, t.c) / whole, twice_area(t.a, t.b, p) / whole};
}

// Gauss nodes on the square, folded to the triangle (Duffy): exact for polynomials of degree 2 order - 2.
void over_triangle(const Corners& t, const UnitRule& rule, const QuadratureSink& sink) {
  const PlanePoint u{t.b.x - t.a.x, t.b.y - t.a.y};
  const PlanePoint v{t.c.x - t.b.x, t.c.y - t.b.y};
  const double area2 = u.x * v.y - u.y * v.x;
  for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
      const double s = rule.nodes[j];
      const double w = s * rule.nodes[k];
      const PlanePoint p{t.a.x + s * u.x + w * v.x, t.a.y + s * u.y + w * v.y};
      sink(from_plane(p), rule.weights[j] * rule.weights[k] * s * area2 * solid_angle_of_area(p));
    }
  }
}

// Between the border edge a to b, counter-clockwise about the normal, and the horizon.
void over_sector(const PlanePoint& a, const PlanePoint& b, const UnitRule& rule, const QuadratureSink& sink) {
  const double across = a.x * b.y - a.y * b.x;
  for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
    const PlanePoint p{a.x + rule.nodes[j] * (b.x - a.x), a.y + rule.nodes[j] * (b.y - a.y)};
    const double inner = std::hypot(p.x, p.y);
    const double turn = rule.weights[j] * across / (inner * inner);  // dphi
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
      const double rho = inner + rule.nodes[k] * (1.0 - inner);
      const PlanePoint q{p.x * rho / inner, p.y * rho / inner};
      sink(from_plane(q), turn * rule.weights[k] * (1.0 - inner) * rho * solid_angle_of_area(q));
    }
  }
}

}  // namespace

Result<MeshRow> MeshRow::make(std::span<const TableNode> nodes) {
  std::vector<PlanePoint> points;
  points.reserve(nodes.size());
  for (const TableNode& node : nodes) points.push_back(plane_point(node.r));
  Result<std::vector<MeshTriangle>> triangles = delaunay(points);
  if (!triangles) return failure(std::move(triangles).error());
  return MeshRow(TriangleSearch(points, std::move(*triangles)));
}

MeshRow::MeshRow(TriangleSearch search)
    : search_(std::move(search)), round_(search_.points().size()), is_border_(search_.points().size(), 0) {
  for (std::size_t t = 0; t < search_.triangles().size(); ++t) {
    double width = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t corner = search_.triangles()[t].corner[k];
      const std::int32_t next = search_.triangles()[t].corner[(k + 1) % 3];
      width = std::max(width, arc(from_plane(search_.points()[at(corner)]), from_plane(search_.points()[at(next)])));
      round_[at(corner)].push_back(static_cast<std::int32_t>(t));
    }
    width_.push_back(width);
  }
  for (const auto& edge : search_.border()) is_border_[at(edge[0])] = is_border_[at(edge[1])] = 1;
}

Stencil MeshRow::locate(const Vector& r) const {
  const MeshPlace place = search_.locate(plane_point(r));
  Stencil stencil{.is_inside = place.is_inside, .place = r};
  PlanePoint p;
  for (std::size_t k = 0; k < (place.is_inside ? 3U : 2U); ++k) {
    const std::size_t corner = at(place.corner[k]);
    stencil.add(corner, place.weight[k]);
    p.x += place.weight[k] * search_.points()[corner].x;
    p.y += place.weight[k] * search_.points()[corner].y;
  }
  if (place.is_inside)
    stencil.width = width_[at(place.triangle)];
  else
    stencil.place = from_plane(p);
  return stencil;
}

std::vector<MeshRow::FarNode> MeshRow::across(const Vector& r) const {
  const MeshPlace place = search_.locate(plane_point(r));
  std::vector<FarNode> found;
  if (!place.is_inside) return found;
  const MeshTriangle& own = search_.triangles()[at(place.triangle)];
  for (const std::int32_t beside : own.neighbour) {
    if (beside == MeshTriangle::kNone) continue;
    const std::array<std::int32_t, 3>& corners = search_.triangles()[at(beside)].corner;
    const auto far = std::ranges::find_if(
        corners, [&](std::int32_t c) { return std::ranges::find(own.corner, c) == own.corner.end(); });
    if (far == corners.end()) continue;
    const std::span<const PlanePoint> points = search_.points();
    found.push_back(
        {.node = at(*far),
         .corner = {at(own.corner[0]), at(own.corner[1]), at(own.corner[2])},
         .weight = affine_weights({points[at(own.corner[0])], points[at(own.corner[1])], points[at(own.corner[2])]},
                                  points[at(*far)])});
  }
  return found;
}

std::vector<std::int32_t> MeshRow::around(std::size_t k) const {
  std::vector<std::int32_t> corners;
  for (const std::int32_t t : round_[k]) {
    const MeshTriangle& triangle = search_.triangles()[at(t)];
    corners.insert(corners.end(), triangle.corner.begin(), triangle.corner.end());
  }
  return corners;
}

std::optional<Stencil> MeshRow::locate_without(std::size_t k, std::optional<std::size_t> mirror_image) const {
  if (is_border_[k] != 0 || round_[k].empty()) return std::nullopt;
  std::vector<std::int32_t> ring = around(k);
  const bool has_image_near =
      mirror_image && std::find(ring.begin(), ring.end(), static_cast<std::int32_t>(*mirror_image)) != ring.end();
  if (has_image_near) {
    const std::vector<std::int32_t> more = around(*mirror_image);
    ring.insert(ring.end(), more.begin(), more.end());
  }
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  std::erase_if(ring, [&](std::int32_t n) { return at(n) == k || (has_image_near && at(n) == *mirror_image); });
  std::vector<PlanePoint> points;
  for (const std::int32_t n : ring) points.push_back(search_.points()[at(n)]);
  Result<std::vector<MeshTriangle>> triangles = delaunay(points);
  if (!triangles) return std::nullopt;
  const MeshPlace place = TriangleSearch(points, std::move(*triangles)).locate(search_.points()[k]);
  if (!place.is_inside) return std::nullopt;
  Stencil stencil;
  for (std::size_t c = 0; c < 3; ++c) stencil.add(at(ring[at(place.corner[c])]), place.weight[c]);
  return stencil;
}

bool MeshRow::quadrature(int order, const QuadratureSink& sink) const {
  const std::span<const PlanePoint> points = search_.points();
  for (const auto& edge : search_.border()) {
    const PlanePoint& a = points[at(edge[0])];
    const PlanePoint& b = points[at(edge[1])];
    if (a.x * b.y - a.y * b.x <= 0.0) return false;
  }
  const UnitRule rule = gauss_legendre(order);
  for (const MeshTriangle& t : search_.triangles()) {
    over_triangle({points[at(t.corner[0])], points[at(t.corner[1])], points[at(t.corner[2])]}, rule, sink);
  }
  for (const auto& edge : search_.border()) over_sector(points[at(edge[0])], points[at(edge[1])], rule, sink);
  return true;
}

}  // namespace gonio::reflectance
