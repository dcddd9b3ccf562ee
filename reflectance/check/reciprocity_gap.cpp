#include "reflectance/check/reciprocity_gap.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace gonio::reflectance {
namespace {

// Doubles in order as integers in order: the negative ones count downwards from 0.
std::int64_t rank(double value) {
  std::int64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits >= 0 ? bits : std::numeric_limits<std::int64_t>::min() - bits;
}

void keep_worse(ReciprocityGap& worst, const ReciprocityGap& other) {
  if (other.ulps <= worst.ulps) return;
  const std::size_t compared = worst.compared;
  worst = other;
  worst.compared = compared;
}

}  // namespace

std::uint64_t ulp_distance(double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<std::uint64_t>::max();
  const auto first = static_cast<std::uint64_t>(rank(a));
  const auto second = static_cast<std::uint64_t>(rank(b));
  return rank(a) >= rank(b) ? first - second : second - first;
}

ReciprocityGap worst_reciprocity_gap(const Surface& surface, std::span<const DirectionPair> pairs) {
  ReciprocityGap worst;
  for (const DirectionPair& pair : pairs) {
    const double forth = in_per_steradian(surface.eval(pair.i, pair.r));
    const double back = in_per_steradian(surface.eval(pair.r, pair.i));
    keep_worse(worst, {.ulps = ulp_distance(forth, back), .pair = pair, .forth = forth, .back = back});
    const Direction m = mirrored(pair.i);
    const double share = surface.specular(pair.i);
    const double mirror_share = surface.specular(m);
    keep_worse(worst, {.ulps = ulp_distance(share, mirror_share),
                       .pair = {.i = pair.i, .r = m},
                       .forth = share,
                       .back = mirror_share,
                       .is_specular = true});
    ++worst.compared;
  }
  return worst;
}

}  // namespace gonio::reflectance
