#pragma once

#include <cstdint>
#include <optional>

#include "base/clock.h"
#include "base/units.h"
#include "drivers/detector.h"

namespace gonio::daemon {

/// One reading that was taken by hand: shown, and kept nowhere. Nothing is subtracted from it.
struct HandReading {
  drivers::DetectorIdentity detector;
  bool is_power = false;        ///< a radiometer's, in W; else a camera's, in DN
  std::optional<double> value;  ///< mean of the aperture's pixels, or of the samples; nothing: an overload
  double noise = 0.0;           ///< standard deviation of one pixel or one sample
  std::int64_t values = 0;      ///< pixels or samples behind the mean
  std::int64_t saturated = 0;   ///< of them at full scale
  double full_scale = 0.0;      ///< DN, or the range in W
  Duration exposure{};          ///< as read back, or what the samples took
  double gain_db = 0.0;
  std::optional<Wavelength> wavelength;  ///< that a radiometer was set to
  std::optional<double> temperature_c;   ///< of the camera
  bool source_shutter_open = false;      ///< while it was taken
  bool detector_shutter_open = false;
};

}  // namespace gonio::daemon
