#pragma once

#include <cstdint>
#include <string>

#include "calibration/raw_reading.h"
#include "drivers/stage_config.h"

namespace gonio::bench {

/// A scan in a store of its own, as goniod would have written it: each reading an attempt or a visit, many of them a
/// commit.
struct StoredGrid {
  std::string file;
  std::int64_t scan = 0;
  drivers::StageConfig stage;
};
/// Into a new file; ends the program with the reason where that fails.
[[nodiscard]] StoredGrid write_grid(const calibration::ScanReadings& readings, const std::string& file);
/// Read back as calibration::calibrate takes it.
[[nodiscard]] calibration::ScanReadings read_grid(const StoredGrid& stored);

}  // namespace gonio::bench
