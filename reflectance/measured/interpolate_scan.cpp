#include "reflectance/measured/interpolate_scan.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gonio::reflectance {
namespace {

// Root mean squares over the readings.
struct Sizes {
  double value = 0.0;
  double noise = 0.0;
};

Sizes sizes_of(const MeasuredScan& scan) {
  const std::vector<std::size_t> usable = usable_points(scan);
  Sizes sizes;
  for (const std::size_t k : usable) {
    const MeasuredPoint& p = scan.points[k];
    sizes.value += p.value.si() * p.value.si() / static_cast<double>(usable.size());
    sizes.noise += p.u_random.si() * p.u_random.si() / static_cast<double>(usable.size());
  }
  return {.value = std::sqrt(sizes.value), .noise = std::sqrt(sizes.noise)};
}

InterpolationCandidate judged(ScanInterpolant interpolant, const Sizes& sizes) {
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
  if (sizes.value == 0.0) return candidate;
  candidate.cv_relative = rms / sizes.value;
  // A reading's own noise, and that of the two or three that told it.
  constexpr double kNoises = 1.4;
  constexpr double kTwiceAsFarApart = 4.0;
  const double rest2 = rms * rms - kNoises * sizes.noise * sizes.noise;
  candidate.u_relative = std::sqrt(std::max(0.0, rest2)) / (kTwiceAsFarApart * sizes.value);
  return candidate;
}

}  // namespace

const ScanInterpolant* Interpolation::next() const {
  return candidates.size() < 2 ? nullptr : &candidates[1].interpolant;
}

const ScanInterpolant* Interpolation::rival() const {
  if (candidates.size() < 2 || candidates[1].cv_rms > kRivalRatio * candidates[0].cv_rms) return nullptr;
  return next();
}

Result<Interpolation> interpolate_scan(const MeasuredScan& scan, const InterpolationOptions& options) {
  GONIO_TRY(check(scan));
  std::vector<Guide> guides = candidate_guides(scan);
  if (options.fitted) guides.push_back({.name = "fitted", .surface = *options.fitted});
  const Sizes sizes = sizes_of(scan);
  Interpolation all;
  for (const Guide& guide : guides) {
    Result<ScanInterpolant> made = ScanInterpolant::make(scan, guide, options.table);
    if (made) all.candidates.push_back(judged(*std::move(made), sizes));
    // The flat guide is above 0 everywhere: what it is refused for is the scan's own.
    if (!made && guide.name == "flat") return failure(std::move(made).error());
  }
  std::stable_sort(
      all.candidates.begin(), all.candidates.end(),
      [](const InterpolationCandidate& a, const InterpolationCandidate& b) { return a.cv_rms < b.cv_rms; });
  return all;
}

}  // namespace gonio::reflectance
