#pragma once

#include <optional>

#include "calibration/anchor_history.h"
#include "calibration/background_history.h"
#include "calibration/calibrate.h"
#include "calibration/dark_history.h"
#include "calibration/drift_history.h"
#include "calibration/instrument_model.h"
#include "calibration/normalised_reading.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// What all readings of a scan are seen by: darks, ambient light, stray light, drift; each as its visits found it.
/// Neither copied nor moved, for readings point into it. Threads: any.
class ScanHistories {
 public:
  /// `instrument` must outlive it.
  ScanHistories(const ScanReadings& scan, const InstrumentModel& instrument, const CalibrationOptions& options);
  ScanHistories(const ScanHistories&) = delete;
  ScanHistories& operator=(const ScanHistories&) = delete;

  [[nodiscard]] const ReadingContext& context() const { return context_; }
  [[nodiscard]] std::optional<DriftLevel> drift_at(Instant when) const {
    return drift_ ? drift_->at(when) : std::nullopt;
  }
  /// Likewise, in its place.
  void find_drift(Instant when, std::optional<DriftLevel>& found) const {
    drift_ ? drift_->find(when, found) : found.reset();
  }
  /// In anchor mode: the standard's visits take the place of reference readings, and drift is theirs.
  [[nodiscard]] const std::optional<AnchorHistory>& anchor() const { return anchor_; }
  [[nodiscard]] ReferenceMode mode() const { return mode_; }
  [[nodiscard]] bool has_trap_visits() const { return !stray_.is_empty(); }

 private:
  ScanHistories(const InstrumentModel& instrument, const CalibrationOptions& options, const ScanReadings& visits);

  DarkHistory darks_;
  BackgroundHistory ambient_;
  BackgroundHistory stray_;
  ReadingContext context_;
  ReferenceMode mode_;
  std::optional<DriftHistory> drift_;
  std::optional<AnchorHistory> anchor_;
};

}  // namespace gonio::calibration
