#include "reflectance/measured/interpolate_scan.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gonio::reflectance {
namespace {

double root_mean_square(const MeasuredScan& scan) {
  const std::vector<std::size_t> usable = usable_points(scan);
  double squares = 0.0;
  for (const std::size_t k : usable) squares += scan.points[k].value.si() * scan.points[k].value.si();
  return std::sqrt(squares / static_cast<double>(usable.size()));
}

InterpolationCandidate judged(ScanInterpolant interpolant, double size) {
  double squares = 0.0;
  double most = 0.0;
  const std::vector<double> errors = interpolant.cross_validation_errors();
  for (const double e : errors) {
    squares += e * e;
    most = std::max(most, std::abs(e));
  }
  InterpolationCandidate candidate{
      .interpolant = std::move(interpolant), .validated = errors.size(), .cv_most = per_steradian(most)};
  if (errors.empty()) return candidate;
  const double rms = std::sqrt(squares / static_cast<double>(errors.size()));
  candidate.cv_rms = per_steradian(rms);
  candidate.cv_relative = size > 0.0 ? rms / size : 0.0;
  return candidate;
}

}  // namespace

const ScanInterpolant* Interpolation::rival() const {
  if (candidates.size() < 2 || candidates[1].cv_rms > kRivalRatio * candidates[0].cv_rms) return nullptr;
  return &candidates[1].interpolant;
}

Result<Interpolation> interpolate_scan(const MeasuredScan& scan, const InterpolationOptions& options) {
  GONIO_TRY(check(scan));
  std::vector<Guide> guides = candidate_guides(scan);
  if (options.fitted) guides.push_back({.name = "fitted", .surface = *options.fitted});
  const double size = root_mean_square(scan);
  Interpolation all;
  for (const Guide& guide : guides) {
    Result<ScanInterpolant> made = ScanInterpolant::make(scan, guide, options.table);
    if (made) all.candidates.push_back(judged(*std::move(made), size));
    // The flat guide is above 0 everywhere: what it is refused for is the scan's own.
    if (!made && guide.name == "flat") return failure(std::move(made).error());
  }
  std::stable_sort(all.candidates.begin(), all.candidates.end(),
                   [](const InterpolationCandidate& a, const InterpolationCandidate& b) { return a.cv_rms < b.cv_rms; });
  return all;
}

}  // namespace gonio::reflectance
