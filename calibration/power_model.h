#pragma once

#include <vector>

#include "base/units.h"
#include "calibration/power_reading.h"

namespace gonio::calibration {

/// What a range's readings are to be multiplied with, to agree with the other ranges.
struct RangeFactor {
  double range_w = 0.0;
  Measured<double> factor{1.0, 0.0};
};

/// What calibration knows of a radiometer, all k = 1. Its linearity is DetectorModel's, full scale that of each range.
struct PowerModel {
  double noise = 0.0;    ///< standard deviation of one average, as part of the range's full scale; random
  double u_range = 0.0;  ///< relative, of each range's gain; cancels between readings in one range
  double u_zero = 0.0;   ///< part of the range's full scale: what the zero may wander between two darks; shared
  std::vector<RangeFactor> ranges;  ///< as compared with each other; one not named: 1 with u_range
};

/// Of the mean of a reading, W^2. By the model, not by the scatter of a handful of samples.
[[nodiscard]] inline double noise_variance_w2(const PowerModel& model, const PowerReading& reading) {
  const double one_average = model.noise * reading.range_w;
  return one_average * one_average / (static_cast<double>(reading.samples) * static_cast<double>(reading.averages));
}

}  // namespace gonio::calibration
