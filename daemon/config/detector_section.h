#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "calibration/aperture_mask.h"
#include "calibration/detector_maps.h"
#include "daemon/config/power_meter.h"

namespace gonio {
class TomlReader;
}

namespace gonio::daemon {

/// Where the maps of a detector lie: calibration/map_file.h. Empty: there is none. As written in instrument.toml,
/// beside which they are looked for.
struct DetectorMapFiles {
  std::string dark;        ///< one layer: offset [DN]; two: and rate [DN/s]
  std::string flat;        ///< one layer: response to even light
  std::string bad_pixels;  ///< one layer: 0 good, anything else bad
  std::string linearity;   ///< one layer: a1; two: and a2
  [[nodiscard]] bool any() const { return !(dark + flat + bad_pixels + linearity).empty(); }
};

enum class CameraLinkKind : std::uint8_t { Gige, Usb3 };

/// The detector as instrument.toml has it. Exposures are shortest * 2^n, up to longest: wall time. A radiometer has
/// neither pixels nor an aperture, and its exposure is the time of one reading.
struct DetectorConfig {
  CameraLinkKind link = CameraLinkKind::Gige;
  std::string address;  ///< not part of the configuration's hash; empty: searched for by its serial number
  std::string serial;   ///< the camera must be this one
  int width_px = 0;     ///< of the region that is read
  int height_px = 0;
  int offset_x_px = 0;  ///< of the region, from the sensor's top left
  int offset_y_px = 0;
  std::string pixel_format;  ///< one of kPixelFormats
  int packet_size_bytes = 0;
  Duration shortest_exposure{};
  Duration longest_exposure{};
  double gain_db = 0.0;
  int frames_at_most = 1;  ///< of one reading
  calibration::ApertureMask aperture;
  DetectorMapFiles map_files;
  std::optional<PowerDetectorConfig> power;  ///< set: a radiometer
};

/// Reads `[detector]` of a camera, but for its kind and model. Mistakes stay in the reader.
[[nodiscard]] DetectorConfig read_detector(TomlReader& table);

/// Reads the files, found beside `directory`, and puts them together; their version is the SHA-256 of all their bytes.
/// Errors: FileUnreadable, InvalidInput (no map, damaged, of another size than the detector's region, or the wrong
/// number of layers).
[[nodiscard]] Result<std::shared_ptr<const calibration::DetectorMaps>> load_detector_maps(
    const DetectorConfig& detector, const std::string& directory);

}  // namespace gonio::daemon
