#pragma once

#include <span>
#include <vector>

#include "daemon/config/instrument.h"

namespace gonio::daemon {

/// Where the axes stand at a point of a plan, in their units.
using Place = stage::PerAxis<double>;

/// What a step from one place to another costs, in s, when nothing is in the way: the slowest axis from rest to rest
/// (or all together, where moves are coordinated),
/// turning points against backlash, and the settling, as `step_time` has them, without looking for the other arm. Cheap
/// enough to be asked millions of times. Axes that stand still in all of `places` are left out.
class StepPrice {
 public:
  StepPrice(const Instrument& instrument, std::span<const Place> places);

  /// One way.
  [[nodiscard]] double way_s(const Place& from, const Place& to) const;
  /// The mean of there and back: what a step costs in a walk that is walked both ways, samples forth, references back.
  [[nodiscard]] double mean_s(const Place& a, const Place& b) const;
  /// Never more than a step costs in which this axis (of `axes`) travels so far.
  [[nodiscard]] double least_s(std::size_t axis, double distance) const;

  /// The axes that differ among the places, as indices of `Place`.
  [[nodiscard]] const std::vector<std::size_t>& axes() const { return axes_; }

 private:
  struct AxisPrice {
    std::size_t place = 0;
    double speed = 1.0;
    double acceleration = 1.0;
    double ramps = 0.0;    ///< length of both ramps together
    double ramps_s = 0.0;  ///< what they cost beyond length / speed
    double settle_s = 0.0;
    double window = 0.0;
    double side = 0.0;  ///< +1 arrives from below, -1 from above, 0 any
    double overrun = 0.0;
    double overrun_s = 0.0;  ///< the way back from the turning point
  };
  [[nodiscard]] static double travel_s(const AxisPrice& axis, double distance);

  std::vector<std::size_t> axes_;
  std::vector<AxisPrice> prices_;
  double settle_of_all_s_ = 0.0;  ///< a step that turns ends with a leg that names every axis
  bool has_sides_ = false;
  bool is_coordinated_ = false;
};

}  // namespace gonio::daemon
