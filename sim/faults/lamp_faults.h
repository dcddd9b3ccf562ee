#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "sim/optics/lamp.h"

namespace gonio::sim {

/// What faults make of the lamp and of its monitor: a factor on the output, in steps, and a monitor that is dead or
/// stuck. Scene time, which does not go back. Threads: one at a time.
class LampFaults {
 public:
  enum class Monitor : std::uint8_t { Good, Dead, Stuck };

  /// From `at_s` on the output is `factor` of what it would be.
  void step(double at_s, double factor) {
    if (factor != 1.0 || !steps_.empty()) steps_.push_back({at_s, factor});
  }
  void set_monitor(Monitor monitor) { monitor_ = monitor; }

  /// The mean factor over [from_s, to_s], `to_s` >= `from_s`: 1 without a step.
  [[nodiscard]] double mean(double from_s, double to_s) const {
    if (steps_.empty()) return 1.0;
    if (to_s <= from_s) return at(from_s);
    double sum = 0.0;
    double factor = at(from_s);
    double begin = from_s;
    for (const Step& step : steps_) {
      if (step.at_s <= from_s || step.at_s >= to_s) continue;
      sum += factor * (step.at_s - begin);
      begin = step.at_s;
      factor = step.factor;
    }
    return (sum + factor * (to_s - begin)) / (to_s - from_s);
  }

  /// What the monitor says of an exposure of which a sound one would say `seen` without the factor.
  [[nodiscard]] MonitorReading shown(MonitorReading seen, double from_s, double to_s) {
    const double factor = mean(from_s, to_s);
    seen.mean *= factor;
    seen.standard_error *= factor;
    if (monitor_ == Monitor::Good) {
      last_ = seen.mean;
    } else {  // a number that does not move has no scatter
      seen.mean = monitor_ == Monitor::Dead ? 0.0 : last_.value_or(seen.mean);
      seen.standard_error = 0.0;
    }
    return seen;
  }
  /// The same for one look.
  [[nodiscard]] double shown_now(double seen, double at_s) const {
    if (monitor_ == Monitor::Good) return seen * mean(at_s, at_s);
    return monitor_ == Monitor::Dead ? 0.0 : last_.value_or(seen);
  }

 private:
  struct Step {
    double at_s = 0.0;
    double factor = 1.0;
  };
  [[nodiscard]] double at(double t_s) const {
    double factor = 1.0;
    for (const Step& step : steps_) {
      if (step.at_s <= t_s) factor = step.factor;
    }
    return factor;
  }

  std::vector<Step> steps_;  ///< in the order of time
  Monitor monitor_ = Monitor::Good;
  std::optional<double> last_;
};

}  // namespace gonio::sim
