#pragma once

#include "base/units.h"

namespace gonio::calibration {

/// One result of a radiometer: the mean of its samples, all in one range.
struct PowerReading {
  double mean_w = 0.0;
  double standard_error_w = 0.0;  ///< by the scatter of the samples
  int samples = 0;
  int averages = 1;         ///< of the meter itself, in each sample
  double range_w = 0.0;     ///< full scale
  Wavelength wavelength{};  ///< for which the meter turned current into power
  friend bool operator==(const PowerReading&, const PowerReading&) = default;
};

}  // namespace gonio::calibration
