#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "reflectance/measured/measured_scan.h"
#include "reflectance/measured/scan_interpolant.h"

namespace gonio::reflectance {

struct InterpolationOptions {
  TableOptions table;                            ///< its symmetry is the scan's own
  std::optional<Surface> fitted = std::nullopt;  ///< a model of the sample, tried as a guide beside the others
};

/// One way to read a scan between its readings, and how well it told each reading from the others.
struct InterpolationCandidate {
  ScanInterpolant interpolant;
  std::size_t validated = 0;  ///< readings that the others could say something of
  Brdf cv_rms;                ///< of the differences; some four times the error between readings, noise included
  Brdf cv_most;               ///< the largest of them
  double cv_relative = 0.0;   ///< cv_rms by the root mean square of the readings
  /// What is left of cv_relative without the noise that the readings state, by 4: the relative error between readings,
  /// u of any weighted sum of them if all of it were of one sign.
  double u_relative = 0.0;
};

/// The scan as a surface, chosen by cross-validation.
struct Interpolation {
  std::vector<InterpolationCandidate> candidates;  ///< best first; at least one

  [[nodiscard]] const ScanInterpolant& best() const { return candidates.front().interpolant; }
  /// The next best: what the choice is worth. Null where there is none.
  [[nodiscard]] const ScanInterpolant* next() const;
  /// The same if its cross-validation is no worse than `kRivalRatio` of the best's, so that it might be as right.
  [[nodiscard]] const ScanInterpolant* rival() const;
  static constexpr double kRivalRatio = 1.5;
};

/// Tries every guide of `candidate_guides`, and the fitted surface. A scan whose readings have no neighbours (a single
/// plane with few of them) is not validated: the flat guide stands first then. Some 40 ms for 1000 readings. Errors: as
/// ScanInterpolant::make.
[[nodiscard]] Result<Interpolation> interpolate_scan(const MeasuredScan& scan,
                                                     const InterpolationOptions& options = {});

}  // namespace gonio::reflectance
