#pragma once

#include <cstdint>

#include "sim/optics/slow_wander.h"
#include "sim/scene/scene.h"

namespace gonio::sim {

/// What the lamp monitor reports of a stretch of time.
struct MonitorReading {
  double mean = 0.0;
  double standard_error = 0.0;
  std::uint32_t samples = 0;
};

/// The lamp and its monitor as functions of scene time, in seconds since the scene began. Immutable; threads: any.
class Lamp {
 public:
  explicit Lamp(const Scene& scene);

  /// The mean output over [from_s, to_s], flicker included: what the sample gets. `to_s` > `from_s`.
  [[nodiscard]] double mean(double from_s, double to_s) const;
  /// The same with what a monitor drifts by itself: what a noiseless one shows.
  [[nodiscard]] double monitored(double from_s, double to_s) const;
  /// The monitor over the same stretch: the lamp, its own slow drift, its own noise (one draw for each `exposure`).
  [[nodiscard]] MonitorReading monitor(double from_s, double to_s, std::uint64_t exposure) const;
  /// One look at the monitor.
  [[nodiscard]] double monitor_now(double at_s) const;

 private:
  [[nodiscard]] double slow_mean(double from_s, double to_s) const;
  [[nodiscard]] double flicker_mean(double from_s, double to_s) const;
  [[nodiscard]] double monitor_drift(double at_s) const;

  std::uint64_t seed_;
  LampSpec spec_;
  double wave_phase_;
  SlowWander drift_;
};

}  // namespace gonio::sim
