#include "calibration/scan_histories.h"

#include <cmath>

namespace gonio::calibration {
namespace {

// Visits of one target; those that cannot be normalised say nothing. The ambient light does not come through the
// lamp's monitor: its level is q by a lamp of 1.
BackgroundHistory history_of(const ScanReadings& scan, Target target, const ReadingContext& context) {
  BackgroundHistory history;
  for (const RawReading& reading : scan.readings) {
    if (reading.target != target) continue;
    RawReading visit = reading;
    for (RawFrame& frame : visit.frames) {
      if (target != Target::Ambient) continue;
      frame.monitor_mean = 1.0;
      frame.monitor_se = 0.0;
    }
    const auto normalised = normalise(visit, context);
    if (!normalised) continue;
    history.add(reading.light_class, {.visit_id = reading.visit_id,
                                      .at = reading.at,
                                      .level = normalised->q,
                                      .u = std::hypot(normalised->u_noise, normalised->u_monitor),
                                      .darks = normalised->darks,
                                      .dq_dambient = normalised->dq_dambient,
                                      .ambient = normalised->ambient});
  }
  history.sort();
  return history;
}

// What belongs to no point: thousands among the millions of readings, which are walked through once.
ScanReadings visits_of(const ScanReadings& scan) {
  ScanReadings visits{.isotropic = scan.isotropic,
                      .reference_mode = scan.reference_mode,
                      .points = {},
                      .drift_limit = scan.drift_limit,
                      .readings = {}};
  for (const RawReading& reading : scan.readings) {
    const bool is_of_target = reading.target == Target::Sample || reading.target == Target::Reference;
    if (!is_of_target || reading.visited_point) visits.readings.push_back(reading);
  }
  return visits;
}

}  // namespace

ScanHistories::ScanHistories(const ScanReadings& scan, const InstrumentModel& instrument,
                             const CalibrationOptions& options)
    : ScanHistories(instrument, options, visits_of(scan)) {}

ScanHistories::ScanHistories(const InstrumentModel& instrument, const CalibrationOptions& options,
                             const ScanReadings& visits)
    : darks_(visits, instrument.detector),
      context_{.darks = &darks_, .detector = &instrument.detector, .left_out = options.left_out},
      mode_(visits.reference_mode) {
  ambient_ = history_of(visits, Target::Ambient, context_);
  if (!ambient_.is_empty()) context_.ambient = &ambient_;
  stray_ = history_of(visits, Target::Trap, context_);
  if (!stray_.is_empty()) context_.stray = &stray_;
  if (mode_ == ReferenceMode::Anchor) anchor_.emplace(visits, context_, instrument);
  if (options.correct_drift && mode_ == ReferenceMode::SameGeometry) drift_.emplace(visits, context_, instrument);
}

}  // namespace gonio::calibration
