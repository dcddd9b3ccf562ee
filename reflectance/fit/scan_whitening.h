#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "reflectance/check/shared_effects.h"
#include "reflectance/fit/dense_algebra.h"

namespace gonio::fit {

/// The error of one reading.
struct ReadingError {
  double u_random = 0.0;  ///< above 0
  reflectance::SharedEffects shared;
};

/// The covariance of readings, V = diag(u^2) + sum c_k c_k^T, as a transform that makes it the unit matrix, without
/// ever writing it down: with y = x/u, A_jk = c_kj/u_j and e = (1 + A^T A)^-1 A^T y,
///   z = (y - A e, e),  |z|^2 = x^T V^-1 x  (Woodbury's identity).
/// e are the shared errors that x makes most likely, in their own standard deviations. n readings with m components
/// each and K in all cost n m^2 + K^3/3 once, n m + K^2 a vector. Immutable; threads: any.
class ScanWhitening {
 public:
  /// Errors: InvalidInput for more than 2048 components.
  [[nodiscard]] static Result<ScanWhitening> make(std::span<const ReadingError> errors);

  [[nodiscard]] std::size_t readings() const { return u_random_.size(); }
  /// Of a whitened vector: readings() + the number of components.
  [[nodiscard]] std::size_t size() const { return u_random_.size() + components_.size(); }
  /// z of x; `z` is as long as size() (asserted).
  void whiten(std::span<const double> x, std::span<double> z) const;

  [[nodiscard]] double u_random(std::size_t reading) const { return u_random_[reading]; }
  /// The component that z[readings() + k] is of.
  [[nodiscard]] std::uint32_t component(std::size_t k) const { return components_[k]; }

 private:
  /// What one component does to one reading, in units of its u_random.
  struct Effect {
    std::uint32_t place;  ///< in components_
    double size;
  };

  ScanWhitening(std::span<const ReadingError> errors, std::vector<std::uint32_t> components);
  [[nodiscard]] std::span<const Effect> effects(std::size_t reading) const {
    return std::span(effects_).subspan(first_[reading], first_[reading + 1] - first_[reading]);
  }
  [[nodiscard]] SquareMatrix normal_matrix() const;

  std::vector<double> u_random_;
  std::vector<std::uint32_t> components_;  ///< ascending
  std::vector<Effect> effects_;            ///< reading by reading
  std::vector<std::size_t> first_;         ///< where those of a reading begin; one more than readings
  PositiveSolver solver_;
};

}  // namespace gonio::fit
