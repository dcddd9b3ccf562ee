#include "daemon/desks/hand_reading_report.h"

#include <fmt/format.h>

namespace gonio::daemon {

Result<ReadDetector> reading_verb(const api::DetectorReadRequest& request) {
  constexpr double kLongest_s = 86400.0;
  ReadDetector verb{.exposure = std::nullopt, .range_w = request.range_w, .lit = request.lit};
  if (!request.exposure_s) return verb;
  if (!(*request.exposure_s > 0.0 && *request.exposure_s <= kLongest_s)) {
    return failure({.code = ErrorCode::OutOfLimits,
                    .device = "detector",
                    .tried = "read it by hand",
                    .seen = fmt::format("exposure {} s", *request.exposure_s),
                    .limit = fmt::format("above 0, up to {} s", kLongest_s),
                    .where = InputLocation{"", 0, "exposure_s"}});
  }
  verb.exposure = seconds(*request.exposure_s);
  return verb;
}

api::DetectorReading reading_report(const HandReading& reading) {
  api::DetectorReading report{
      .detector = fmt::format("{} {} {}", reading.detector.vendor, reading.detector.model, reading.detector.serial),
      .unit = reading.is_power ? "W" : "DN",
      .value = reading.value,
      .noise = reading.noise,
      .values = reading.values,
      .saturated = reading.saturated,
      .full_scale = reading.full_scale,
      .exposure_s = in_seconds(reading.exposure),
      .gain_db = reading.gain_db,
      .wavelength_nm = std::nullopt,
      .temperature_c = reading.temperature_c,
      .source_shutter_open = reading.source_shutter_open,
      .detector_shutter_open = reading.detector_shutter_open};
  if (reading.wavelength) report.wavelength_nm = in_nanometres(*reading.wavelength);
  return report;
}

}  // namespace gonio::daemon
