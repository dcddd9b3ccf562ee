#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "base/units.h"
#include "calibration/detector_maps.h"
#include "calibration/instrument_model.h"
#include "daemon/config/detector_section.h"
#include "daemon/config/holds.h"
#include "daemon/config/power_meter.h"
#include "drivers/links/serial_line.h"
#include "drivers/stage_config.h"

namespace gonio::daemon {

/// Where the stage answers: Modbus TCP, or Modbus RTU on a serial line. Not part of the configuration's hash.
struct StageAddress {
  std::string host;
  std::uint16_t port = 0;
  std::optional<drivers::SerialLine> serial;  ///< when set, host and port are not
};

/// Where the carriage stands for each target.
struct CarriagePositions {
  Length sample;
  Length reference;
  Length trap;
  std::optional<Length> open{};  ///< where nothing stands in the source's beam; none: there is no such place
};

enum class FilterSide : std::uint8_t { Detector, Source };

/// What is in one slot of the filter wheel.
struct Filter {
  int slot = 0;
  Wavelength centroid;
  Wavelength fwhm;
  double out_of_band_fraction = 0.0;  ///< of the signal, 0..1
  FilterSide side = FilterSide::Detector;
  /// Set: an attenuator stands with it, which passes this part of the light. Only for looks into the source.
  std::optional<Measured<double>> attenuation{};
};

/// The keep-out about retro-reflection: the detector's head in the source's beam.
struct Shadow {
  Length detector_head_radius;
  Length source_head_radius;
  Length detector_arm;
  Length source_arm;
};

/// Half angles of the cones that the detector and the source fill, seen from the sample.
struct ConeAngles {
  Angle detector_half;
  Angle source_half;
};

/// Outside of this band, in the monitor's unit, the lamp counts as failed.
struct LampBand {
  double low = 0.0;
  double high = 0.0;
  double least_scatter = 0.0;   ///< relative, of one sample: a monitor that scatters less is stuck; 0: not looked at
  bool before_shutter = false;  ///< the monitor sees the lamp also while the source's shutter is closed
  std::optional<LampWarmUp> warm_up;
};

/// The instrument as its file describes it: everything that goniod knows of it. A value: share it as const.
struct Instrument {
  std::string name;
  std::string text;                 ///< the file, verbatim: stored with each scan
  std::string sha256;               ///< of the text without addresses, as hex: scans resume under the same one only
  std::string reference_directory;  ///< where the standards' files lie; absolute, or relative to the working directory
  StageAddress stage_address;
  drivers::StageConfig stage;
  CarriagePositions carriage;
  std::vector<Filter> filters;
  Shadow shadow;
  DetectorConfig detector;
  std::shared_ptr<const calibration::DetectorMaps> maps;  ///< of the detector; nullptr: none configured
  std::optional<PowerMonitorConfig> monitor;              ///< nothing: the stage's own
  ConeAngles cones;
  LampBand lamp;
  HoldRules holds;
  calibration::InstrumentModel model;

  /// Whether the stage latches encoders and monitor over each exposure of the detector.
  [[nodiscard]] bool has_gate() const { return stage.has_gate && !detector.power; }
};

/// Reads and checks the text. Errors: InvalidInput, UnknownKey, MissingKey, each with file, line, field and limit.
/// `file` is the path shown in errors; `reference_directory` is resolved beside it.
[[nodiscard]] Result<Instrument> parse_instrument(std::string_view text, const std::string& file);
/// And the detector's maps, whose version becomes part of the hash. Errors: as parse_instrument and load_detector_maps,
/// FileUnreadable.
[[nodiscard]] Result<Instrument> read_instrument(const std::string& path);

/// The filter for a wavelength, or nullptr: of those without an attenuator the one whose centroid lies within half its
/// FWHM, the nearest of them.
[[nodiscard]] const Filter* filter_for(const Instrument& instrument, Wavelength wavelength);
/// Likewise of those with one.
[[nodiscard]] const Filter* attenuated_filter_for(const Instrument& instrument, Wavelength wavelength);

}  // namespace gonio::daemon
