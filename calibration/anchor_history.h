#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "calibration/drift_history.h"
#include "calibration/geometry_factor.h"
#include "calibration/instrument_model.h"
#include "calibration/normalised_reading.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// What the standard would have read at the anchor at some moment.
struct AnchorReading {
  /// q between the visits, with the darks of both; the rest of the nearest one. Its own noise is 0: it stands in
  /// `terms`.
  NormalisedReading reading;
  std::int64_t reading_id = 0;      ///< of the nearest visit
  std::vector<RelativeTerm> terms;  ///< each visit's noise, and what a straight line between two of them misses
  double u_drift_rest = 0.0;        ///< relative: what of the latter no other reading shares
  double drift_rest_dof = std::numeric_limits<double>::infinity();
  bool is_extrapolated = false;  ///< before the first visit or after the last, or there is only one
  bool is_large = false;         ///< the two visits differ by more than the plan's limit
};

/// The visits of the standard at the anchor, by wavelength: q is linear in time between two of them. What the line
/// misses is DriftHistory's to say. One visit alone holds for all times. Immutable; threads: any.
class AnchorHistory {
 public:
  AnchorHistory(const ScanReadings& scan, const ReadingContext& context, const InstrumentModel& instrument);

  /// Errors: IncompleteData (no visit of the standard with a positive signal at this wavelength).
  [[nodiscard]] Result<AnchorReading> at(Wavelength wavelength, Instant when) const;

 private:
  std::map<std::int64_t, DriftHistory> by_wavelength_;  ///< in pm
};

}  // namespace gonio::calibration
