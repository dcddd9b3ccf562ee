#pragma once

#include <array>
#include <span>

#include "reflectance/table/stencil.h"

namespace gonio::reflectance {

/// A smooth function of the direction that follows the outer readings of an incidence, to say how the BRDF goes on
/// where the readings end: six terms, 1, mu, and x and y each with and without mu. Threads: any.
class Continuation {
 public:
  /// Constant: nothing changes beyond the reach.
  Continuation() = default;
  /// Fitted to the nodes within 40 deg of the outermost, least sum of absolute deviations, so that a peak among them
  /// counts as little as it covers. Constant for fewer than 6 of them.
  explicit Continuation(std::span<const TableNode> nodes);

  [[nodiscard]] double operator()(const Vector& r) const;

 private:
  static constexpr std::size_t kTerms = 6;
  [[nodiscard]] static std::array<double, kTerms> terms(const Vector& r);
  std::array<double, kTerms> coefficient_{};
};

}  // namespace gonio::reflectance
