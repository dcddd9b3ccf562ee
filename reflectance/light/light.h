#pragma once

#include <concepts>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "reflectance/light/beam.h"
#include "reflectance/light/sky.h"
#include "reflectance/light/sun_disk.h"

namespace gonio::reflectance {

/// The kinds of light that quadrature has to treat apart.
using LightSource = std::variant<Beam, SunDisk, Sky>;

/// A summand of a light: weight x source.
struct LightPart {
  LightSource source;
  double weight = 1.0;
};

/// Incident radiance L_i: a weighted sum of beams, disks and skies. All parts are in one unit of radiance, W m^-2 sr^-1
/// or any other. Copies are cheap. Threads: any.
///   const Light light = sun + 0.3 * sky;
class Light {
 public:
  template <class S>
  requires(!std::same_as<S, Light> && std::convertible_to<S, LightSource>) Light(S source)  // NOLINT: a source is light
      : parts_{LightPart{.source = LightSource(std::move(source))}} {}

  [[nodiscard]] std::span<const LightPart> parts() const { return parts_; }
  /// L_i from direction i, beams left out: theirs is a delta.
  [[nodiscard]] double radiance_from(const Direction& i) const;

  friend Light operator+(Light a, const Light& b);
  /// `factor` finite and at least 0 (asserted).
  friend Light operator*(double factor, Light light);

 private:
  std::vector<LightPart> parts_;
};

[[nodiscard]] Light operator+(Light a, const Light& b);
[[nodiscard]] Light operator*(double factor, Light light);

}  // namespace gonio::reflectance
