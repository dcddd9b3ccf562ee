#pragma once

#include <array>
#include <cstddef>

namespace gonio::calibration {

/// What a straight line between two visits misses at the part p of their interval, 0 at both visits: e(p). For a random
/// walk tied down at both ends (Brownian bridge), and just so for one step at a moment that nobody knows,
///   cov(e(p), e(q)) = wander^2 (min(p, q) - p q).
/// Its series in independent errors Z_k of deviation 1 (Karhunen 1947, Loeve 1948; Shorack and Wellner 1986, 5.2)
///   e(p) = wander sum_k sqrt(2) sin(k pi p) / (k pi) Z_k
/// is what readings of one interval have in common, with its signs. The first modes are kept one by one; the rest
/// changes faster than readings come and counts as each reading's own.
inline constexpr std::size_t kBridgeModes = 4;

struct BridgeParts {
  std::array<double, kBridgeModes> mode{};  ///< per unit of wander and standard deviation of Z_k, signed
  double rest = 0.0;                        ///< the same of all other modes together; >= 0
};
/// Of e(p), p within [0, 1].
[[nodiscard]] BridgeParts bridge_at(double p);
/// Of e(q) - e(p): what two readings of one interval do not have in common.
[[nodiscard]] BridgeParts bridge_between(double p, double q);

}  // namespace gonio::calibration
