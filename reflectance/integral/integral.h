#pragma once

#include <cmath>
#include <cstdint>

namespace gonio::reflectance {

/// A computed integral. `error` estimates |value - truth| from the last refinement, rounding included: it is meant to
/// be an upper bound, and stands above the asked tolerance when the work's bound was reached first.
struct Integral {
  double value = 0.0;
  double error = 0.0;
  std::uint64_t evaluations = 0;  ///< of the integrand; 0 for a closed form

  /// What a formula gave, with the rounding that it may have: 4e-15 relative.
  [[nodiscard]] static Integral closed(double value) { return {.value = value, .error = 4e-15 * std::abs(value)}; }

  void add(const Integral& part, double weight) {
    value += weight * part.value;
    error += std::abs(weight) * part.error;
    evaluations += part.evaluations;
  }
};

}  // namespace gonio::reflectance
