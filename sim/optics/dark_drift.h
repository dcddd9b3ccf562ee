#pragma once

#include <optional>

#include "base/units.h"
#include "sim/optics/slow_wander.h"
#include "sim/scene/scene.h"

namespace gonio::sim {

/// How a detector's dark rate, offset and temperature change with scene time. Immutable; threads: any.
///   rate / rate(0) = (1 + per_hour t) (1 + wander w(t)) 2^((T(t) - T0) / doubling),  T(t) = T0 + swing sin(2 pi t /
///   period)
/// the doubling as of silicon (Janesick, Photon Transfer, 2007, ch. 11). Without a spec: 1, no shift, T0.
class DarkDrift {
 public:
  explicit DarkDrift(const Scene& scene);

  /// Factor of the dark rate, never below 0.
  [[nodiscard]] double rate_factor(double scene_s) const;
  [[nodiscard]] double offset_shift_dn(double scene_s) const;
  [[nodiscard]] Temperature detector_temperature(double scene_s) const;

 private:
  Temperature rest_;
  std::optional<DarkDriftSpec> spec_;
  std::optional<SlowWander> rate_wander_;
  std::optional<SlowWander> offset_wander_;
};

}  // namespace gonio::sim
