#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "base/clock.h"
#include "calibration/dark_history.h"
#include "calibration/instrument_model.h"
#include "calibration/normalised_reading.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// A visit of the standard at the visits' geometry.
struct ReferenceVisit {
  std::int64_t visit_id = 0;
  Instant at{};
  double level = 1.0;           ///< q in units of the first visit's
  double u = 0.0;               ///< of the level: noise, monitor, darks, placing
  double u_own = 0.0;           ///< likewise without the darks, which other readings rest on too
  NormalisedReading reading;    ///< all readings of the visit together
  std::int64_t reading_id = 0;  ///< RawReading::id of the first of them
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
  /// Standard deviation over a whole interval of this length of what no line follows; `change` with two visits only.
  double wander = 0.0;
  double wander_dof = std::numeric_limits<double>::infinity();  ///< how well `wander` is known
  double beyond = 0.0;    ///< of an interval, from the nearest visit; 0 between two visits
  bool is_large = false;  ///< the change is beyond the scan's drift limit, and beyond chance
  [[nodiscard]] bool is_between() const { return before != nullptr && after != nullptr; }
};

/// What the lamp's monitor does not see: the response to one unchanging thing, the standard at one geometry, as the
/// visits found it. Visits at another point than the first are left out. Immutable; threads: any.
/// What no line follows: each inner visit lies off the line between its neighbours by r, of variance s dt1 dt2 / (dt1 +
/// dt2) for a random walk or for steps at random moments, and by nothing for a steady drift. The mean of (r^2 - the
/// visits' own noise) (dt1 + dt2) / (dt1 dt2) over the inner visits is s, with as many degrees of freedom; the bridge
/// over the part p of an interval T then has the variance s T p (1 - p) (Brownian bridge). A single large step throws
/// the visits on both sides of it off to opposite sides: where that stands clear of the rest by four standard
/// deviations, its interval alone has it, as a step at an unknown moment, and its visits do not count for s.
class DriftHistory {
 public:
  DriftHistory(const ScanReadings& scan, const ReadingContext& context, const InstrumentModel& instrument);

  /// Linear in time between the two bracketing visits; beyond the first or last, the nearest. Nothing with fewer than
  /// two visits. The pointers live as long as this object.
  [[nodiscard]] std::optional<DriftLevel> at(Instant when) const;
  /// Likewise, in its place: what is copied as soon as it is written waits for its writing.
  void find(Instant when, std::optional<DriftLevel>& found) const;
  /// In time order.
  [[nodiscard]] const std::vector<ReferenceVisit>& visits() const { return visits_; }

 private:
  /// A visit beside the line between its neighbours.
  struct Off {
    double r = 0.0;
    double noise2 = 0.0;
    double bridge_s = 0.0;  ///< dt1 dt2 / (dt1 + dt2)
    bool is_taken_out = false;
  };
  /// Of one interval, over its whole length.
  struct Wander {
    double usual = 0.0;
    double step = 0.0;
  };
  [[nodiscard]] DriftLevel between(std::size_t n) const;
  [[nodiscard]] Off off_line(std::size_t n) const;
  [[nodiscard]] double step_within(const std::vector<Off>& offs, std::size_t n) const;
  [[nodiscard]] bool take_out_step(std::vector<Off>& offs, std::vector<double>& steps) const;
  void find_wander();

  std::vector<ReferenceVisit> visits_;  ///< in time order
  std::optional<double> limit_;
  std::vector<Wander> wanders_;        ///< of each interval; empty: too few visits
  std::vector<DriftLevel> intervals_;  ///< what `between` says of each
  double wander_dof_ = 0.0;
};

}  // namespace gonio::calibration
