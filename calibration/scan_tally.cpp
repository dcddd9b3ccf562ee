#include "calibration/scan_tally.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/parallel_blocks.h"

namespace gonio::calibration {
namespace {

double median(LargeArray<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace

void ScanTally::add(const CalibratedPoint& point) {
  expanded.push_back(point.budget.expanded.si());
  if (!has(point.flags, PointFlag::NearZero)) relative.push_back(expanded.back() / std::abs(point.value.si()));
}

ScanSummary summary_of(std::span<const ScanTally> blocks, int threads) {
  ScanSummary summary;
  double chi2 = 0.0;
  double dof = 0.0;
  for (const ScanTally& block : blocks) {
    summary.points += block.expanded.size();
    summary.near_zero += block.expanded.size() - block.relative.size();
    summary.refused += block.refused;
    for (const double u : block.relative)
      summary.worst_relative_expanded = std::max(summary.worst_relative_expanded, u);
    chi2 += block.frame_chi2;
    dof += block.frame_dof;
  }
  summary.frame_chi2_per_dof = dof > 0.0 ? chi2 / dof : 0.0;
  constexpr std::array kLists = {&ScanTally::expanded, &ScanTally::relative};
  std::array<double, kLists.size()> medians{};
  for_blocks(kLists.size(), threads, [&](std::size_t list) {
    LargeArray<double> all;
    all.reserve(summary.points);
    for (const ScanTally& block : blocks) {
      const LargeArray<double>& part = block.*kLists[list];
      all.insert(all.end(), part.begin(), part.end());
    }
    medians[list] = median(all);
  });
  summary.median_expanded = per_steradian(medians[0]);
  summary.median_relative_expanded = medians[1];
  return summary;
}

}  // namespace gonio::calibration
