#include "calibration/scan_histories.h"

#include <cmath>

namespace gonio::calibration {
namespace {

double square_of(double x) {
  return x * x;
}

// Of q: the noise of the reading, of its monitor and of the dark and ambient visits that it rests on. Those visits are
// shared with other readings; what that correlation is worth is below the noise of a frame.
double u_of_background(const NormalisedReading& reading) {
  double variance = square_of(reading.u_noise) + square_of(reading.u_monitor);
  for (const DarkShare& share : reading.darks) {
    const DarkLevel& dark = share.level;
    if (dark.before != nullptr) {
      variance += square_of(share.dq_dlevel * (1.0 - dark.weight_after) * dark.before->u_dn);
    }
    if (dark.after != nullptr) variance += square_of(share.dq_dlevel * dark.weight_after * dark.after->u_dn);
  }
  if (reading.ambient) {
    const BackgroundLevel& a = *reading.ambient;
    if (a.before != nullptr) variance += square_of(reading.dq_dambient * (1.0 - a.weight_after) * a.before->u);
    if (a.after != nullptr) variance += square_of(reading.dq_dambient * a.weight_after * a.after->u);
  }
  return std::sqrt(variance);
}

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
    history.add(
        reading.light_class,
        {.visit_id = reading.visit_id, .at = reading.at, .level = normalised->q, .u = u_of_background(*normalised)});
  }
  history.sort();
  return history;
}

}  // namespace

ScanHistories::ScanHistories(const ScanReadings& scan, const InstrumentModel& instrument,
                             const CalibrationOptions& options)
    : darks_(scan, instrument.detector),
      context_{.darks = &darks_, .detector = &instrument.detector, .left_out = options.left_out} {
  ambient_ = history_of(scan, Target::Ambient, context_);
  if (!ambient_.is_empty()) context_.ambient = &ambient_;
  stray_ = history_of(scan, Target::Trap, context_);
  if (!stray_.is_empty()) context_.stray = &stray_;
  if (options.correct_drift) drift_.emplace(scan, context_, instrument);
}

}  // namespace gonio::calibration
