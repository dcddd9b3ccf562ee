#pragma once

#include <cstdint>
#include <optional>

#include "base/error.h"
#include "reflectance/light/sky.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// Stands between a quadrature and what it evaluates: counts, and notes the first value that ends the integral. After
/// one, the quadrature runs on over zeros to its end and its result is thrown away.
class Watch {
 public:
  /// L_i; a value that is negative or not finite is noted and read as 0.
  [[nodiscard]] double radiance(const Sky& sky, const Direction& i);
  /// The sky's closed ring mean at the theta of i, if it has one, likewise.
  [[nodiscard]] std::optional<double> ring_mean(const Sky& sky, const Direction& i);
  /// f; a value that is not finite is noted and read as 0, a negative one is noted and counts.
  [[nodiscard]] double brdf(const Surface& surface, const Direction& i, const Direction& r);
  /// The same for a value of `surface` that is there already.
  [[nodiscard]] double noted_brdf(Brdf f, const Surface& surface, const Direction& i, const Direction& r);

  [[nodiscard]] const std::optional<Error>& error() const { return error_; }
  [[nodiscard]] bool has_seen_negative_brdf() const { return has_seen_negative_brdf_; }
  [[nodiscard]] std::uint64_t radiances() const { return radiances_; }

 private:
  [[nodiscard]] double noted(double radiance, const Direction& i);
  std::optional<Error> error_;
  std::uint64_t radiances_ = 0;
  bool has_seen_negative_brdf_ = false;
};

/// `surface` as the quadratures of ../integral see it, each of its values passing by `watch`, which has to outlive it.
/// Itself where its rho_dh is closed and no quadrature will come.
[[nodiscard]] Surface watched(const Surface& surface, Watch& watch);

}  // namespace gonio::reflectance
