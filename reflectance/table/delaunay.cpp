#include "reflectance/table/delaunay.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>

namespace gonio::reflectance {
namespace {

using Index = std::int32_t;
__extension__ typedef __int128 Int128;  // NOLINT: the in-circle determinant needs 126 bits

constexpr Index kNone = MeshTriangle::kNone;

// A point in units of 2^-30: differences fit 32 bits, so orientation is exact in 64 bits and the in-circle test in 128.
struct GridPoint {
  std::int64_t x;
  std::int64_t y;
};

std::int64_t orientation(const GridPoint& a, const GridPoint& b, const GridPoint& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

// Above 0 when p lies inside of the circle through a, b, c (counter-clockwise).
bool is_in_circle(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& p) {
  const GridPoint u{a.x - p.x, a.y - p.y};
  const GridPoint v{b.x - p.x, b.y - p.y};
  const GridPoint w{c.x - p.x, c.y - p.y};
  const auto lift = [](const GridPoint& q) { return Int128{q.x * q.x + q.y * q.y}; };
  const auto cross = [](const GridPoint& q, const GridPoint& r) { return Int128{q.x * r.y - q.y * r.x}; };
  return lift(u) * cross(v, w) + lift(v) * cross(w, u) + lift(w) * cross(u, v) > 0;
}

// Near in the list, near in the plane: the search for a point's triangle starts at the last one made.
std::uint64_t along_z_curve(const GridPoint& p) {
  std::uint64_t code = 0;
  for (int bit = 31; bit >= 0; --bit) {
    const auto x = static_cast<std::uint64_t>(p.x + (std::int64_t{1} << 31));
    const auto y = static_cast<std::uint64_t>(p.y + (std::int64_t{1} << 31));
    code = (code << 2) | (((x >> bit) & 1U) << 1) | ((y >> bit) & 1U);
  }
  return code;
}

std::size_t at(Index k) {
  return static_cast<std::size_t>(k);
}

// Triangles beyond the hull have kNone as one corner, a point at infinity: then every triangle has three neighbours
// and a point outside of the hull needs no case of its own.
class Builder {
 public:
  explicit Builder(std::span<const PlanePoint> points) {
    constexpr double kUnit = 0x1p30;
    for (const PlanePoint& p : points) {
      assert(std::abs(p.x) <= 1.0 && std::abs(p.y) <= 1.0);
      points_.push_back({std::llround(p.x * kUnit), std::llround(p.y * kUnit)});
    }
    order_.resize(points_.size());
    std::iota(order_.begin(), order_.end(), Index{0});
    std::stable_sort(order_.begin(), order_.end(),
                     [&](Index a, Index b) { return along_z_curve(point(a)) < along_z_curve(point(b)); });
  }

  // False when all points lie on one line.
  [[nodiscard]] bool build() {
    if (!start()) return false;
    for (const Index k : order_) insert(k);
    return true;
  }

  [[nodiscard]] std::vector<MeshTriangle> finished();

 private:
  [[nodiscard]] const GridPoint& point(Index k) const { return points_[at(k)]; }
  [[nodiscard]] bool start();
  void insert(Index p);
  [[nodiscard]] Index conflicting(const GridPoint& p) const;
  [[nodiscard]] bool in_conflict(const MeshTriangle& t, const GridPoint& p) const;
  void clear_cavity(Index first, const GridPoint& p);
  void fill_cavity(Index p);
  void peel_flat();

  struct CavityEdge {
    Index from;
    Index to;
    Index outer;  ///< the triangle beyond
  };

  std::vector<GridPoint> points_;
  std::vector<Index> order_;
  std::vector<MeshTriangle> triangles_;
  std::vector<char> is_free_;
  std::vector<Index> free_;
  std::vector<CavityEdge> border_;
  std::vector<Index> cavity_;
  std::vector<Index> made_from_;  ///< the new triangle whose edge starts at a corner; the last is the point at infinity
  Index last_ = 0;
};

std::size_t infinite_corner(const MeshTriangle& t) {
  return static_cast<std::size_t>(std::find(t.corner.begin(), t.corner.end(), kNone) - t.corner.begin());
}

// The first three points that are no line, and the three triangles at infinity around them.
bool Builder::start() {
  if (order_.size() < 3) return false;
  std::size_t third = 2;
  while (third < order_.size() && orientation(point(order_[0]), point(order_[1]), point(order_[third])) == 0) ++third;
  if (third == order_.size()) return false;
  const Index a = order_[0];
  Index b = order_[1];
  Index c = order_[third];
  order_.erase(order_.begin() + static_cast<std::ptrdiff_t>(third));
  order_.erase(order_.begin(), order_.begin() + 2);
  if (orientation(point(a), point(b), point(c)) < 0) std::swap(b, c);
  triangles_ = {{.corner = {a, b, c}, .neighbour = {1, 2, 3}},
                {.corner = {c, b, kNone}, .neighbour = {3, 2, 0}},
                {.corner = {a, c, kNone}, .neighbour = {1, 3, 0}},
                {.corner = {b, a, kNone}, .neighbour = {2, 1, 0}}};
  is_free_.assign(4, 0);
  made_from_.assign(points_.size() + 1, kNone);
  return true;
}

bool Builder::in_conflict(const MeshTriangle& t, const GridPoint& p) const {
  const std::size_t ghost = infinite_corner(t);
  if (ghost == 3) return is_in_circle(point(t.corner[0]), point(t.corner[1]), point(t.corner[2]), p);
  const GridPoint& a = point(t.corner[(ghost + 1) % 3]);
  const GridPoint& b = point(t.corner[(ghost + 2) % 3]);
  const std::int64_t side = orientation(a, b, p);
  if (side != 0) return side > 0;
  // On the line of a border edge: its circle is the edge itself.
  return (p.x - a.x) * (p.x - b.x) + (p.y - a.y) * (p.y - b.y) < 0;
}

// Walks from the last triangle made towards p; ends in the triangle that holds it or in one at infinity that sees it.
Index Builder::conflicting(const GridPoint& p) const {
  Index t = last_;
  if (const std::size_t ghost = infinite_corner(triangles_[at(t)]); ghost < 3) t = triangles_[at(t)].neighbour[ghost];
  while (infinite_corner(triangles_[at(t)]) == 3) {
    const MeshTriangle& here = triangles_[at(t)];
    std::size_t k = 0;
    while (k < 3 && orientation(point(here.corner[(k + 1) % 3]), point(here.corner[(k + 2) % 3]), p) >= 0) ++k;
    if (k == 3) return t;
    t = here.neighbour[k];
  }
  return t;
}

void Builder::clear_cavity(Index first, const GridPoint& p) {
  border_.clear();
  cavity_.assign(1, first);
  is_free_[at(first)] = 1;
  for (std::size_t next = 0; next < cavity_.size(); ++next) {
    const MeshTriangle t = triangles_[at(cavity_[next])];
    for (std::size_t k = 0; k < 3; ++k) {
      const Index outer = t.neighbour[k];
      if (is_free_[at(outer)] != 0) continue;
      if (in_conflict(triangles_[at(outer)], p)) {
        is_free_[at(outer)] = 1;
        cavity_.push_back(outer);
      } else {
        border_.push_back({.from = t.corner[(k + 1) % 3], .to = t.corner[(k + 2) % 3], .outer = outer});
      }
    }
  }
  free_.insert(free_.end(), cavity_.begin(), cavity_.end());
}

void Builder::fill_cavity(Index p) {
  const auto slot = [&](Index corner) -> Index& {
    return corner == kNone ? made_from_.back() : made_from_[at(corner)];
  };
  for (const CavityEdge& edge : border_) {
    Index t = static_cast<Index>(triangles_.size());
    if (free_.empty()) {
      triangles_.emplace_back();
      is_free_.push_back(0);
    } else {
      t = free_.back();
      free_.pop_back();
      is_free_[at(t)] = 0;
    }
    triangles_[at(t)] = {.corner = {p, edge.from, edge.to}, .neighbour = {edge.outer, kNone, kNone}};
    // The outer triangle holds the edge the other way round: what is opposite to it comes after `from`.
    MeshTriangle& outer = triangles_[at(edge.outer)];
    for (std::size_t k = 0; k < 3; ++k) {
      if (outer.corner[(k + 1) % 3] == edge.to && outer.corner[(k + 2) % 3] == edge.from) outer.neighbour[k] = t;
    }
    slot(edge.from) = t;
    last_ = t;
  }
  for (const CavityEdge& edge : border_) {
    const Index t = slot(edge.from);
    const Index after = slot(edge.to);
    triangles_[at(t)].neighbour[1] = after;
    triangles_[at(after)].neighbour[2] = t;
  }
}

void Builder::insert(Index p) {
  clear_cavity(conflicting(point(p)), point(p));
  fill_cavity(p);
}

// Takes border triangles away whose height over the border is next to nothing; two of their sides become border, and
// so may uncover more.
void Builder::peel_flat() {
  constexpr double kFlat = 1e-6;
  bool again = true;
  while (again) {
    again = false;
    for (Index t = 0; t < static_cast<Index>(triangles_.size()); ++t) {
      if (is_free_[at(t)] != 0) continue;
      const MeshTriangle& here = triangles_[at(t)];
      for (std::size_t k = 0; k < 3; ++k) {
        if (here.neighbour[k] != kNone) continue;
        const GridPoint& a = point(here.corner[(k + 1) % 3]);
        const GridPoint& b = point(here.corner[(k + 2) % 3]);
        const double length = std::hypot(static_cast<double>(b.x - a.x), static_cast<double>(b.y - a.y));
        const auto area2 = static_cast<double>(orientation(a, b, point(here.corner[k])));
        if (area2 > kFlat * length * length) continue;
        is_free_[at(t)] = 1;
        for (const Index n : here.neighbour) {
          if (n == kNone) continue;
          std::replace(triangles_[at(n)].neighbour.begin(), triangles_[at(n)].neighbour.end(), t, kNone);
        }
        again = true;
        break;
      }
    }
  }
}

std::vector<MeshTriangle> Builder::finished() {
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    if (is_free_[t] != 0 || infinite_corner(triangles_[t]) == 3) continue;
    is_free_[t] = 1;
    for (const Index n : triangles_[t].neighbour) {
      if (n == kNone) continue;
      std::replace(triangles_[at(n)].neighbour.begin(), triangles_[at(n)].neighbour.end(), static_cast<Index>(t),
                   kNone);
    }
  }
  peel_flat();
  std::vector<Index> renamed(triangles_.size(), kNone);
  std::vector<MeshTriangle> kept;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    if (is_free_[t] != 0) continue;
    renamed[t] = static_cast<Index>(kept.size());
    kept.push_back(triangles_[t]);
  }
  for (MeshTriangle& t : kept) {
    for (Index& n : t.neighbour) n = n == kNone ? kNone : renamed[at(n)];
  }
  return kept;
}

}  // namespace

Result<std::vector<MeshTriangle>> delaunay(std::span<const PlanePoint> points) {
  Builder builder(points);
  if (builder.build()) {
    std::vector<MeshTriangle> triangles = builder.finished();
    if (!triangles.empty()) return triangles;
  }
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = "triangulate directions",
                  .seen = std::to_string(points.size()) + " directions on one line",
                  .limit = "at least three that are no line"});
}

}  // namespace gonio::reflectance
