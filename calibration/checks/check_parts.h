#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibration/checks/check_scan.h"
#include "calibration/normalised_reading.h"
#include "calibration/scan_histories.h"
#include "reflectance/check/group_chi_square.h"
#include "reflectance/check/symmetry_point.h"

// What the checks of this folder share.
namespace gonio::calibration {

/// The probability that |z| of a normal deviate exceeds this, either way.
[[nodiscard]] double beyond(double z);
/// What a variance known by `degrees_of_freedom` may be at most, with 99.9 % certainty, over what it was found to be: 1
/// for infinity; below 3 as for 3.
[[nodiscard]] double widened(double degrees_of_freedom);

/// Puts chi-square and worst z together, and the verdict. `n`: deviations that the worst was chosen from.
void judge(ScanCheck& check, std::size_t n);
/// Likewise without a chi-square.
void judge_by_worst(ScanCheck& check, std::size_t n);

/// A calibrated point for reflectance/check: what scatters, and what it shares with a sign. Nothing for a point whose
/// uncertainty is not positive.
[[nodiscard]] std::optional<reflectance::SymmetryPoint> symmetry_point(const CalibratedPoint& point,
                                                                       std::span<const Component> components);

/// chi-square of groups into `check`; its p value with the worst of `n` deviations. A refusal becomes its finding.
void judge_groups(ScanCheck& check, std::span<const std::vector<reflectance::GroupMember>> groups, std::size_t n);

/// A reading as one number with all that is random in it, for comparing readings of one geometry.
struct LevelReading {
  const RawReading* raw = nullptr;
  NormalisedReading reading;
  double u = 0.0;  ///< of q: noise, monitor and darks, widened by their degrees of freedom; without placing
};
[[nodiscard]] std::optional<LevelReading> level_of(const RawReading& raw, const ReadingContext& context);

// One check each, in order of CheckKind.
[[nodiscard]] ScanCheck check_closure(const CalibratedScan& calibrated, const CheckInputs& inputs);
[[nodiscard]] ScanCheck check_reciprocity(const CalibratedScan& calibrated, const CheckInputs& inputs);
[[nodiscard]] ScanCheck check_left_right(const CalibratedScan& calibrated, const CheckInputs& inputs);
[[nodiscard]] ScanCheck check_energy(const CalibratedScan& calibrated, const CheckInputs& inputs);
[[nodiscard]] ScanCheck check_repeats(const CalibratedScan& calibrated, const CheckInputs& inputs);
[[nodiscard]] ScanCheck check_dark_history(const CheckInputs& inputs);
[[nodiscard]] ScanCheck check_exposures(const CheckInputs& inputs);

}  // namespace gonio::calibration
