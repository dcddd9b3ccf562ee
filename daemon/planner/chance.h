#pragma once

#include <cstddef>
#include <cstdint>

#include "base/split_mix.h"

namespace gonio::daemon {

/// Random bits, and whole numbers below a bound.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : stream_(seed) {}

  std::uint64_t next() { return stream_.next(); }
  /// In [0, bound). The bias of the remainder is below 2^-40 for the 10^7 points that a plan may have.
  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(next() % bound); }

 private:
  SplitMix stream_;
};

}  // namespace gonio::daemon
