#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "calibration/dark_history.h"
#include "calibration/instrument_model.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// A visit of the standard at the visits' geometry.
struct ReferenceVisit {
  std::int64_t visit_id = 0;
  Instant at{};
  double level = 1.0;  ///< q in units of the first visit's
  double u = 0.0;      ///< of the level: noise, monitor, darks, placing
};

/// The instrument's response at a moment, in units of that at the first visit.
struct DriftLevel {
  double level = 1.0;
  const ReferenceVisit* before = nullptr;  ///< one of the two may be missing: then the level is the other's, unchanged
  const ReferenceVisit* after = nullptr;
  double weight_after = 0.0;  ///< of `after`; 1 - weight_after of `before`
  /// What the level changed by over its interval (the nearest one beyond the visits), beyond the visits' own noise; >=
  /// 0.
  double change = 0.0;
  double beyond = 0.0;    ///< of an interval, from the nearest visit; 0 between two visits
  bool is_large = false;  ///< the change is beyond the scan's drift limit, and beyond chance
  [[nodiscard]] bool is_between() const { return before != nullptr && after != nullptr; }
};

/// What the lamp's monitor does not see: the response to one unchanging thing, the standard at one geometry, as the
/// visits found it. Visits at another point than the first are left out. Immutable; threads: any.
class DriftHistory {
 public:
  DriftHistory(const ScanReadings& scan, const DarkHistory& darks, const InstrumentModel& instrument);

  /// Linear in time between the two bracketing visits; beyond the first or last, the nearest. Nothing with fewer than
  /// two visits. The pointers live as long as this object.
  [[nodiscard]] std::optional<DriftLevel> at(Instant when) const;

 private:
  [[nodiscard]] DriftLevel between(const ReferenceVisit& a, const ReferenceVisit& b) const;

  std::vector<ReferenceVisit> visits_;  ///< in time order
  std::optional<double> limit_;
};

}  // namespace gonio::calibration
