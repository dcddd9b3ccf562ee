#pragma once

// The instrument as the daemon was told of it, and readings taken by hand; units in the names, as in the JSON (json.h).
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gonio::api {

/// An axis as instrument.toml has it, in its own unit.
struct AxisLimits {
  std::string name;  ///< "theta_i"
  std::string unit;  ///< "deg", "mm" or "slot"
  double low = 0.0;
  double high = 0.0;
  double speed_per_s = 0.0;
  double acceleration_per_s2 = 0.0;
  double settle_s = 0.0;
  double window = 0.0;  ///< +- about a target: arrived
};

struct FilterReport {
  int slot = 0;
  double centroid_nm = 0.0;
  double fwhm_nm = 0.0;
  std::string side;                   ///< "detector" or "source"
  std::optional<double> attenuation;  ///< what an attenuator beside it passes; absent: none
};

struct InstrumentReport {
  std::string name;
  std::string sha256;
  std::string stage_link;  ///< "tcp 192.0.2.7:502", "rtu /dev/ttyUSB0 at 115200 baud"
  double heartbeat_timeout_s = 0.0;
  std::vector<AxisLimits> axes;
  std::vector<FilterReport> filters;
  double sample_mm = 0.0;
  double reference_mm = 0.0;
  double trap_mm = 0.0;
  std::optional<double> open_mm;  ///< where nothing stands in the beam
  std::string detector_serial;
  double shortest_exposure_s = 0.0;
  double longest_exposure_s = 0.0;
  double full_scale_dn = 0.0;
  double read_noise_dn = 0.0;
  double electrons_per_dn = 0.0;
  double monitor_low = 0.0;
  double monitor_high = 0.0;
  std::int64_t store_free_bytes = 0;  ///< on the store's disk
};

/// A reading that was taken by hand, with nothing subtracted.
struct DetectorReading {
  std::string detector;         ///< vendor, model, serial number
  std::string unit;             ///< of value, noise and full scale: "DN" or "W"
  std::optional<double> value;  ///< mean; absent: an overload
  double noise = 0.0;           ///< standard deviation of one pixel or sample
  std::int64_t values = 0;      ///< pixels or samples behind the mean
  std::int64_t saturated = 0;   ///< of them at full scale
  double full_scale = 0.0;
  double exposure_s = 0.0;
  double gain_db = 0.0;
  std::optional<double> wavelength_nm;  ///< that a radiometer was set to
  std::optional<double> temperature_c;
  bool source_shutter_open = false;
  bool detector_shutter_open = false;
};

}  // namespace gonio::api
