#include "reflectance/sampling/alias_table.h"

#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>

namespace gonio::reflectance {

AliasTable::AliasTable(std::span<const double> weights) {
  assert(!weights.empty() && weights.size() <= (std::size_t{1} << 31U));
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  assert(std::isfinite(sum) && sum > 0.0);
  const std::size_t size = std::bit_ceil(weights.size());
  mask_ = static_cast<std::uint32_t>(size - 1);

  std::vector<double> left(size);  // what of each weight is not yet placed, in places
  for (std::size_t k = 0; k < weights.size(); ++k) left[k] = weights[k] / sum * static_cast<double>(size);
  std::vector<std::uint32_t> small;
  std::vector<std::uint32_t> large;
  for (std::uint32_t k = 0; k < size; ++k) (left[k] < 1.0 ? small : large).push_back(k);

  places_.resize(size);
  while (!small.empty() && !large.empty()) {
    const std::uint32_t few = small.back();
    const std::uint32_t many = large.back();
    small.pop_back();
    places_[few] = {.threshold = static_cast<std::uint32_t>(left[few] * 0x1p32), .first = few, .second = many};
    left[many] -= 1.0 - left[few];
    if (left[many] >= 1.0) continue;
    large.pop_back();
    small.push_back(many);
  }
  // Full places, but for rounding.
  for (const std::uint32_t k : large) places_[k] = {.threshold = 0, .first = k, .second = k};
  for (const std::uint32_t k : small) places_[k] = {.threshold = 0, .first = k, .second = k};
}

}  // namespace gonio::reflectance
