#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "calibration/instrument_model.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// An exposure and gain, or a range: each has its own dark. Made of what the detector says it used.
struct ExposureRung {
  std::int64_t exposure_us = 0;
  std::int64_t gain_mdb = 0;
  std::int64_t range_pw = 0;  ///< of a radiometer, which has neither exposure nor gain; 0: a camera
  friend auto operator<=>(const ExposureRung&, const ExposureRung&) = default;
};
[[nodiscard]] ExposureRung rung_of(const RawFrame& frame);

/// The mean dark level of one visit at one rung. In W instead of DN for a radiometer.
struct DarkVisit {
  std::int64_t visit_id = 0;
  Instant at{};
  double level_dn = 0.0;
  double u_dn = 0.0;                ///< of the level, from the noise of its frames
  double pixel_variance_dn2 = 0.0;  ///< of one pixel of one dark frame: read noise and the dark current's shot noise
};

/// The dark level at a moment, and what it rests on.
struct DarkLevel {
  double level_dn = 0.0;
  double pixel_variance_dn2 = 0.0;
  const DarkVisit* before = nullptr;  ///< one of the two may be missing: then it is the other's level, unchanged
  const DarkVisit* after = nullptr;
  double weight_after = 0.0;    ///< weight of `after`; 1 - weight_after of `before`
  double drift_widening = 1.0;  ///< factor on the stated drift between darks: larger beyond the last dark
  [[nodiscard]] bool is_extrapolated() const { return before == nullptr || after == nullptr; }
};

/// What one dark level did to a reading: dq/dD [1/s per unit of the monitor] times the weight of each bracketing visit.
struct DarkShare {
  ExposureRung rung;
  DarkLevel level;
  double dq_dlevel = 0.0;    ///< of the interpolated level
  double light_share = 0.0;  ///< of the reading's light: what its gain or range acts on
};

/// All dark visits of a scan, by rung. Immutable; threads: any.
class DarkHistory {
 public:
  DarkHistory(const ScanReadings& scan, const DetectorModel& detector);

  /// Linear in time between the two bracketing visits of the same rung; beyond the first or last, the nearest. Nothing
  /// when no dark was taken at this rung. The pointers live as long as this object.
  [[nodiscard]] std::optional<DarkLevel> at(ExposureRung rung, Instant when) const;
  /// Likewise, in its place: what is copied as soon as it is written waits for its writing. False: nothing.
  [[nodiscard]] bool find(ExposureRung rung, Instant when, DarkLevel& level) const;
  [[nodiscard]] const std::map<ExposureRung, std::vector<DarkVisit>>& visits() const { return visits_; }

 private:
  std::map<ExposureRung, std::vector<DarkVisit>> visits_;  ///< in time order
};

}  // namespace gonio::calibration
