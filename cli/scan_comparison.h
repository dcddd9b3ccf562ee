#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "cli/output.h"
#include "protocol/api/reports.h"

namespace gonio::cli {

/// One point of two scans of the same plan. Values in sr^-1.
struct ComparedPoint {
  api::BrdfReport a;
  api::BrdfReport b;
  double difference = 0.0;           ///< b - a
  double expanded_u = 0.0;           ///< U of the difference: k times what does not cancel
  double difference_in_u = 0.0;      ///< difference / U
  double normalised_residual = 0.0;  ///< difference / (U / k)
};

/// Two scans of the same plan, point by point.
///
/// What does not cancel is what each scan drew anew: readings, its visits of the dark (`u_own_per_sr`). Certificate,
/// aperture, linearity and the like are the same for both and cancel, as long as standard and instrument are. The
/// visits of the dark are shared by the points of one scan, so the residuals are not quite independent: chi-square
/// spreads a little more than its number of degrees of freedom says.
struct ScanComparison {
  std::vector<ComparedPoint> points;  ///< with a value in both
  std::int64_t without_a_value = 0;   ///< in one of them
  double chi_square = 0.0;
  std::optional<std::size_t> worst;  ///< of `points`, by |difference| in U

  /// Chi-square is no more than four of its standard deviations above its mean: chance does that once in 10^4.
  [[nodiscard]] bool do_agree() const;
};

/// Pairs by the points' numbers. A value without `u_own_per_sr` (of an older daemon) goes by `u_random_per_sr`.
[[nodiscard]] ScanComparison compare_values(const std::vector<api::BrdfReport>& a,
                                            const std::vector<api::BrdfReport>& b);

[[nodiscard]] Table view(const ScanComparison& comparison);
/// "chi-square 5.1 for 6 points, worst point 3 ...".
[[nodiscard]] std::string summary_of(const ScanComparison& comparison);

}  // namespace gonio::cli
