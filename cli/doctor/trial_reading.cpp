#include "cli/doctor/trial_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/output.h"
#include "protocol/api/json.h"

namespace gonio::cli {
namespace {

constexpr double kMostDark = 0.5;    // of full scale
constexpr double kLeastLight = 5.0;  // standard errors

std::string reading_text(const api::DetectorReading& reading) {
  const std::string value = reading.value ? number_text(*reading.value) + " " + reading.unit : "an overload";
  return fmt::format("{}, noise {} {}, {} of {} saturated, full scale {} {}", value, number_text(reading.noise, 3),
                     reading.unit, reading.saturated, reading.values, number_text(reading.full_scale), reading.unit);
}

double standard_error(const api::DetectorReading& reading) {
  return reading.noise / std::sqrt(static_cast<double>(std::max<std::int64_t>(reading.values, 1)));
}

}  // namespace

std::string trial_reading_body(bool lit) {
  return api::to_json(api::DetectorReadRequest{.lit = lit});
}

std::string to_the_reference_body(const api::InstrumentReport& instrument) {
  api::MoveRequest move{.carriage_mm = instrument.reference_mm};
  if (!instrument.filters.empty()) move.filter_wheel_slot = instrument.filters.front().slot;
  return api::to_json(move);
}

Finding check_dark_reading(const api::DetectorReading& dark) {
  Finding finding{.check = "detector reads in the dark",
                  .seen = reading_text(dark),
                  .limit = fmt::format("below {} {}", number_text(kMostDark * dark.full_scale), dark.unit)};
  if (!dark.value || dark.saturated > 0 || *dark.value >= kMostDark * dark.full_scale) {
    finding.verdict = Verdict::Failed;
    finding.remedy = "does the detector's shutter close, and is the room dark?";
  } else if (dark.unit == "DN" && *dark.value <= 0.0) {
    finding.verdict = Verdict::Warning;
    finding.remedy = "a clipped dark is a biased dark: raise the camera's black level";
  }
  return finding;
}

Finding check_lit_reading(const api::DetectorReading& lit, const api::DetectorReading& dark) {
  const double least = kLeastLight * std::hypot(standard_error(lit), standard_error(dark));
  Finding finding{.check = "detector sees the lamp",
                  .seen = reading_text(lit),
                  .limit = fmt::format("{} {} above the dark", number_text(least, 3), lit.unit)};
  if (!lit.value || lit.saturated > 0) {
    finding.verdict = Verdict::Warning;
    finding.remedy = "a scan takes shorter exposures, or a larger range; if none is short enough: less light";
  } else if (!dark.value || *lit.value - *dark.value <= least) {
    finding.verdict = Verdict::Failed;
    finding.remedy = "is the lamp on, do both shutters open, does the detector look at the reference?";
  }
  return finding;
}

}  // namespace gonio::cli
