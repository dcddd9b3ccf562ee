#pragma once

#include <cmath>

#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// Henyey and Greenstein's (1941) phase function of the phase angle xi, (1 - g^2) / (1 + g^2 + 2 g cos xi)^1.5, mean 1
/// over the sphere; g below 0 scatters back, towards xi = 0. The denominator is a sum of two positive parts on either
/// side of g = 0, so that the peak keeps its digits as |g| -> 1.
class HenyeyGreenstein {
 public:
  /// -1 < g < 1.
  explicit HenyeyGreenstein(double g)
      : g_(g), numerator_((1.0 - g) * (1.0 + g)), offset_((1.0 - std::abs(g)) * (1.0 - std::abs(g))) {}

  [[nodiscard]] double g() const { return g_; }
  [[nodiscard]] double numerator() const { return numerator_; }  ///< 1 - g^2
  [[nodiscard]] double offset() const { return offset_; }        ///< (1 - |g|)^2
  /// `t` = separation_terms(i, r), which most callers have already.
  [[nodiscard]] double operator()(const Direction& i, const Direction& r, const SeparationTerms& t) const {
    const double q = g_ < 0.0 ? offset_ - 4.0 * g_ * sin2_half_phase(t) : offset_ + 4.0 * g_ * cos2_half_phase(i, r);
    return numerator_ / (q * std::sqrt(q));
  }

 private:
  double g_;
  double numerator_;
  double offset_;
};

}  // namespace gonio::reflectance
