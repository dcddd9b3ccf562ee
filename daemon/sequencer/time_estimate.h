#pragma once

#include <cstdint>

#include "base/clock.h"
#include "daemon/planner/planned_scan.h"

namespace gonio::daemon {

/// Mean and scatter of durations (Welford 1962).
class DurationStatistics {
 public:
  void add(Duration d);
  [[nodiscard]] std::int64_t count() const { return n_; }
  [[nodiscard]] double mean_s() const { return mean_s_; }
  /// Of one; 0 below two values.
  [[nodiscard]] double variance_s2() const { return n_ > 1 ? m2_s2_ / static_cast<double>(n_ - 1) : 0.0; }

 private:
  std::int64_t n_ = 0;
  double mean_s_ = 0.0;
  double m2_s2_ = 0.0;
};

/// A duration still to come, with the standard uncertainty of its estimate.
struct Remaining {
  double time_s = 0.0;
  double variance_s2 = 0.0;
};

/// `left` more of what was measured: n * mean; variance n s^2 of the sum plus n^2 s^2 / m of the mean.
[[nodiscard]] Remaining remaining(const DurationStatistics& measured, std::int64_t left);

TimeParts& operator+=(TimeParts& sum, const TimeParts& more);

}  // namespace gonio::daemon
