#pragma once

#include <string>

#include "drivers/stage_config.h"

namespace gonio::bench {

/// What a scan took, and what it must take: from the encoders of its readings and the speeds of its axes alone.
struct ScanTimes {
  double wall_s = 0.0;    ///< from `running` to its end, visits included
  double move_s = 0.0;    ///< of each step between two exposures, the slowest axis' trapezoid
  double settle_s = 0.0;  ///< the longest of the axes that moved
  double expose_s = 0.0;  ///< of all frames, of visits too
  double commit_s = 0.0;  ///< idle by cause, as stored
  double wire_s = 0.0;
  double device_s = 0.0;
  double hold_s = 0.0;
  double planning_s = 0.0;
  double read_s = 0.0;
  long items = 0;
  long visits = 0;
  long frames = 0;
  [[nodiscard]] double must_s() const { return move_s + settle_s + expose_s; }
};

/// Reads one scan of a store. Throws on a file that is none.
[[nodiscard]] ScanTimes read_scan_times(const std::string& store, long scan, const drivers::StageConfig& stage);

}  // namespace gonio::bench
