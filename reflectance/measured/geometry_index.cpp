#include "reflectance/measured/geometry_index.h"

#include <algorithm>
#include <cmath>

#include "reflectance/table/stencil.h"

namespace gonio::reflectance {
namespace {

double largest_arc(const DirectionPair& a, const DirectionPair& b) {
  return std::max(arc(a.i.vector(), b.i.vector()), arc(a.r.vector(), b.r.vector()));
}

// The pair turned about the normal by `turn`, and mirrored before when asked.
DirectionPair turned_pair(const DirectionPair& p, Angle turn, bool is_mirrored) {
  const double side = is_mirrored ? -1.0 : 1.0;
  return {.i = Direction::from_cosine(p.i.mu(), p.i.sin_theta(), side * p.i.phi() + turn),
          .r = Direction::from_cosine(p.r.mu(), p.r.sin_theta(), side * p.r.phi() + turn)};
}

}  // namespace

GeometryIndex::GeometryIndex(const CompareOptions& options)
    : options_(options), width_(std::max(1e-6, options.tolerance.si())) {}

GeometryIndex::Cell GeometryIndex::cell_of(const DirectionPair& pair) const {
  return {std::llround(pair.i.theta().si() / width_), std::llround(pair.r.theta().si() / width_)};
}

// Turned so that the directions farther from the pole lie at one azimuth.
double GeometryIndex::distance(const DirectionPair& a, const DirectionPair& b) const {
  if (options_.sameness == Sameness::Exact) return largest_arc(a, b);
  const bool by_i = a.i.sin_theta() >= a.r.sin_theta();
  const auto best_turn = [&](bool is_mirrored) {
    const Angle phi = by_i ? b.i.phi() : b.r.phi();
    const Angle turn = (by_i ? a.i.phi() : a.r.phi()) - (is_mirrored ? -phi : phi);
    return largest_arc(a, turned_pair(b, turn, is_mirrored));
  };
  const double turned = best_turn(false);
  return options_.sameness == Sameness::Turned ? turned : std::min(turned, best_turn(true));
}

std::optional<std::size_t> GeometryIndex::nearest(const DirectionPair& pair) const {
  std::optional<std::size_t> found;
  double least = options_.tolerance.si() + 1e-12;
  const Cell home = cell_of(pair);
  for (std::int64_t di = -1; di <= 1; ++di) {
    for (std::int64_t dr = -1; dr <= 1; ++dr) {
      const auto [first, last] = cells_.equal_range({home.first + di, home.second + dr});
      for (auto it = first; it != last; ++it) {
        const double off = distance(pair, pairs_.at(it->second));
        if (off > least || is_taken_.contains(it->second)) continue;
        if (found && off == least) continue;
        found = it->second;
        least = off;
      }
    }
  }
  return found;
}

void GeometryIndex::add(const DirectionPair& pair, std::size_t id) {
  cells_.emplace(cell_of(pair), id);
  pairs_.emplace(id, pair);
}

}  // namespace gonio::reflectance
