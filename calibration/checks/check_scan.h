#pragma once

#include <vector>

#include "calibration/calibrated_scan.h"
#include "calibration/checks/scan_check.h"
#include "calibration/instrument_model.h"
#include "calibration/raw_reading.h"
#include "calibration/reference_standard.h"

namespace gonio::calibration {

/// What a scan is checked with beside its values.
struct CheckInputs {
  const ScanReadings& scan;
  const InstrumentModel& instrument;
  const ReferenceStandard& standard;
  bool sample_is_the_standard = false;  ///< then its values are to be the standard's own
};

/// All checks in the order of kAllChecks, each with its verdict: nothing is dropped, and nothing is changed.
///
/// Each deviation is judged by what does not cancel in it: random parts, and of shared ones the difference of the
/// sensitivities where their sign is the error's own (certificate, shape modes, zeros, visits ...); sizes without a
/// sign (unresolved slopes, interpolation, the lamp's wander) add as squares. A part known by nu degrees of freedom is
/// widened to what it may be with 99.9 % certainty (nu / chi^2_nu), for one s can be too small for a whole scan. A
/// check that has a chi-square fails by it or by its worst z, each at half of kFalseAlarm, the worst z among n at 1 / n
/// of it (Bonferroni: right for any correlation). Pure; threads: any. 20 000 points with 500 components take some 2 s.
[[nodiscard]] std::vector<ScanCheck> check_scan(const CalibratedScan& calibrated, const CheckInputs& inputs);

/// "failed: reciprocity, dark-history", "passed: 5 of 7 had something to compare".
[[nodiscard]] std::string summary_of(const std::vector<ScanCheck>& checks);

}  // namespace gonio::calibration
