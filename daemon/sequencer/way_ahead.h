#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/clock.h"
#include "daemon/config/instrument.h"
#include "daemon/planner/planned_scan.h"
#include "protocol/stage/axis.h"

namespace gonio::daemon {

/// What the steps along a scan's order take by the axes' own speeds, carriage aside. A few steps are looked at at a
/// time, so that a scan of a million points begins at once.
class WayAhead {
 public:
  /// Looks at `steps` more of the steps.
  void look_on(const Instrument& instrument, const std::vector<ScanPoint>& points,
               const std::vector<std::int32_t>& order, int steps);

  struct Length {
    double time_s = 0.0;    ///< moves and settling
    double unseen_s = 0.0;  ///< the part of it that is the mean of what was looked at
  };
  /// Of the steps from place `from` to place `to` of the order.
  [[nodiscard]] Length between(std::size_t from, std::size_t to) const;
  /// The turns between sample and reference that are to come.
  struct Turns {
    double time_s = 0.0;
    double u_s = 0.0;
  };
  struct Blocks {
    std::size_t begun = 0;  ///< the place where the block in hand began
    bool is_on_reference = false;
    double work_s = 0.0;  ///< of a sample item, beyond its way
    double pass_s = 0.0;  ///< sample items are measured for so long
    double to_reference_s = 0.0;
  };
  /// Plays the blocks that are to come. Takes a millisecond.
  [[nodiscard]] Turns turns(const Instrument& instrument, const std::vector<ScanPoint>& points,
                            const std::vector<std::int32_t>& order, const Blocks& blocks) const;

 private:
  [[nodiscard]] std::size_t end_of_block(std::size_t begin, std::size_t size, const Blocks& blocks) const;
  std::vector<double> until_s_;  ///< by place: the time from place 0 there
  stage::PerAxis<double> standing_{};
};

}  // namespace gonio::daemon
