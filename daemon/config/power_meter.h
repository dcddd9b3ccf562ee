#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/units.h"

namespace gonio::daemon {

/// A radiometer on USB as instrument.toml has it, whatever it serves as.
struct PowerMeterConfig {
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::string serial;      ///< the meter must be this one
  int averages = 1;        ///< of the meter itself, in each sample
  Duration sample_time{};  ///< of one average
  Duration settle{};       ///< after a change of range or wavelength, or a zero
};

/// A radiometer in the place of the camera: a reading is a number of samples in one range.
struct PowerDetectorConfig {
  PowerMeterConfig meter;
  std::vector<double> ranges_w;  ///< full scales that may be used, the largest first
  int samples = 10;              ///< of one reading
  bool zero = true;              ///< while a scan is prepared, with the shutter closed
  Duration zero_time{};          ///< at most

  /// Of one reading, without what the wire takes.
  [[nodiscard]] Duration reading_time() const { return meter.averages * samples * meter.sample_time; }
};

/// A radiometer in the lamp's light: it is read while the detector is.
struct PowerMonitorConfig {
  static constexpr int kFewestSamples = 8;  ///< fewer have no scatter to speak of
  static constexpr int kMostSamples = 10000;

  PowerMeterConfig meter;
  Wavelength wavelength;  ///< of the light that it sees
  double range_w = 0.0;

  /// As many samples as cover `window`.
  [[nodiscard]] int samples_in(Duration window) const;
};

}  // namespace gonio::daemon
