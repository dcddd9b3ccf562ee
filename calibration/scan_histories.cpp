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

}  // namespace

ScanHistories::ScanHistories(const ScanReadings& scan, const InstrumentModel& instrument,
                             const CalibrationOptions& options)
    : darks_(scan, instrument.detector),
      context_{.darks = &darks_, .detector = &instrument.detector, .left_out = options.left_out},
      mode_(scan.reference_mode) {
  ambient_ = history_of(scan, Target::Ambient, context_);
  if (!ambient_.is_empty()) context_.ambient = &ambient_;
  stray_ = history_of(scan, Target::Trap, context_);
  if (!stray_.is_empty()) context_.stray = &stray_;
  if (mode_ == ReferenceMode::Anchor) anchor_.emplace(scan, context_, instrument);
  if (options.correct_drift && mode_ == ReferenceMode::SameGeometry) drift_.emplace(scan, context_, instrument);
}

}  // namespace gonio::calibration
