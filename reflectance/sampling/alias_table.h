#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gonio::reflectance {

/// Choice of one of many by its weight, in constant time (Walker 1977, built as by Vose 1991): each of 2^n places holds
/// one entry, or two of which a threshold decides. Probabilities are kept to 2^-32 of a place. Immutable; threads: any.
class AliasTable {
 public:
  /// Weights finite and at least 0, one of them above 0; up to 2^31 (asserted).
  explicit AliasTable(std::span<const double> weights);

  /// 64 random bits choose the index of a weight.
  [[nodiscard]] std::uint32_t choose(std::uint32_t place_bits, std::uint32_t threshold_bits) const {
    const Place& place = places_[place_bits & mask_];
    return threshold_bits < place.threshold ? place.first : place.second;
  }

 private:
  struct Place {
    std::uint32_t threshold = 0;
    std::uint32_t first = 0;
    std::uint32_t second = 0;
  };
  std::vector<Place> places_;
  std::uint32_t mask_ = 0;
};

}  // namespace gonio::reflectance
