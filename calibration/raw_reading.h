#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "base/geometry.h"
#include "base/large_array.h"
#include "calibration/power_reading.h"

namespace gonio::calibration {

/// What stood in the detector's view. Dark: its own shutter. Ambient: the source's shutter closed, whatever target.
/// Trap: the lamp on a black trap. Never renumbered.
enum class Target : std::uint8_t { Sample, Reference, Dark, Ambient, Trap };

/// The linear polarisation of the light that falls on the target. Any: as the lamp gives it.
enum class Polarisation : std::uint8_t { Any, S, P };

/// What a sample's reading is compared with.
enum class ReferenceMode : std::uint8_t {
  SameGeometry,  ///< the standard at the same directions
  Anchor,        ///< the standard at one geometry, and a factor for the geometry
  Absolute,      ///< the direct beam and the detector's solid angle
};

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

/// The mean that a frame's light has by the maps of its detector (detector_maps.h): dark map subtracted, linearised,
/// divided by the flat field.
struct ReducedMean {
  std::uint32_t n = 0;   ///< pixels that counted
  double mean_dn = 0.0;  ///< signed
  /// Of the mean, from this frame's noise by the photon-transfer model (EMVA 1288 release 4.0, eq 5): random.
  double u_noise_dn = 0.0;
  /// Of the mean, from the maps' own noise: the same error in every frame that was reduced with them.
  double u_maps_dn = 0.0;
  friend bool operator==(const ReducedMean&, const ReducedMean&) = default;
};

/// One frame with what was latched over exactly its exposure; or one result of a radiometer, which has no pixels.
struct RawFrame {
  RegionMoments region;
  std::optional<ReducedMean> reduced;  ///< where the detector has maps
  double exposure_s = 0.0;
  double gain_db = 0.0;
  double monitor_mean = 0.0;
  double monitor_se = 0.0;  ///< standard error of that mean
  Geometry at_open;         ///< encoders at the start and the end of the exposure, as angles
  Geometry at_close;
  double detector_temperature_c = 0.0;
  std::optional<PowerReading> power;  ///< of a radiometer: then region, exposure and gain count for nothing
  /// What the light is taken from: the reduced mean where there is one. DN.
  [[nodiscard]] double signal_dn() const { return reduced ? reduced->mean_dn : region.mean; }
};

/// One reading as stored: repeated frames of one target at one geometry.
struct RawReading {
  std::int64_t id = 0;
  Target target = Target::Sample;
  std::optional<std::int32_t> point_index;    ///< of the plan; none for a visit
  std::optional<std::int32_t> visited_point;  ///< where a visit of the standard or the sample was made
  std::int64_t visit_id = 0;  ///< which visit or attempt it belongs to: readings of one visit share its noise
  Wavelength wavelength;
  Instant at{};  ///< middle of the exposures
  /// Readings are cleared of the ambient and stray light of visits in their own class of geometries.
  std::int32_t light_class = 0;
  bool has_saturated = false;  ///< exposures of it were saturated: they are not among `frames`
  std::vector<RawFrame> frames;
};

/// A planned point, by its commanded directions.
struct PlannedPoint {
  std::int32_t index = 0;
  Geometry geometry;
  Wavelength wavelength;
  Polarisation polarisation = Polarisation::Any;
  bool is_blocked = false;  ///< one arm's head stands in the other's light there
};

/// Everything of one scan that its BRDF depends on, but for the calibration itself.
struct ScanReadings {
  bool isotropic = true;
  ReferenceMode reference_mode = ReferenceMode::SameGeometry;
  std::vector<PlannedPoint> points;
  std::optional<double> drift_limit;  ///< of the plan, relative: readings between two visits beyond it are flagged
  LargeArray<RawReading> readings;    ///< accepted attempts and all visits, in time order
};

}  // namespace gonio::calibration
