#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "base/geometry.h"

namespace gonio::calibration {

/// What stood in the detector's view.
enum class Target : std::uint8_t { Sample, Reference, Dark };

/// Pixel statistics of one frame inside the aperture mask, in DN, before dark and flat: what the wire said, condensed.
struct RegionMoments {
  std::uint32_t n = 0;  ///< pixels
  double mean = 0.0;    ///< DN
  double m2 = 0.0;      ///< central moments, DN^2, DN^3, DN^4 (divided by n)
  double m3 = 0.0;
  double m4 = 0.0;
  std::uint32_t saturated = 0;  ///< pixels at full scale
  friend bool operator==(const RegionMoments&, const RegionMoments&) = default;
};

/// One frame with what was latched over exactly its exposure.
struct RawFrame {
  RegionMoments region;
  double exposure_s = 0.0;
  double gain_db = 0.0;
  double monitor_mean = 0.0;
  double monitor_se = 0.0;  ///< standard error of that mean
  Geometry at_open;         ///< encoders at the start and the end of the exposure, as angles
  Geometry at_close;
  double detector_temperature_c = 0.0;
};

/// One reading as stored: repeated frames of one target at one geometry.
struct RawReading {
  std::int64_t id = 0;
  Target target = Target::Sample;
  std::optional<std::int32_t> point_index;  ///< of the plan; none for a dark
  std::int64_t visit_id = 0;  ///< which visit or attempt it belongs to: readings of one visit share its noise
  Wavelength wavelength;
  Instant at{};  ///< middle of the exposures
  std::vector<RawFrame> frames;
};

/// A planned point, by its commanded directions.
struct PlannedPoint {
  std::int32_t index = 0;
  Geometry geometry;
  Wavelength wavelength;
};

/// Everything of one scan that its BRDF depends on, but for the calibration itself.
struct ScanReadings {
  bool isotropic = true;
  std::vector<PlannedPoint> points;
  std::vector<RawReading> readings;  ///< accepted attempts and all dark visits, in time order
};

}  // namespace gonio::calibration
