#include "calibration/reading_pairs.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <tuple>
#include <unordered_map>

namespace gonio::calibration {
namespace {

using StandardPlace = std::tuple<std::int64_t, Polarisation, std::int64_t, std::int64_t, std::int64_t>;

StandardPlace place_of(const PlannedPoint& point) {
  const auto key = [](Angle a) { return std::llround(in_degrees(a) * 1e3); };
  const Geometry& g = point.geometry;
  const std::int64_t dphi = std::abs(key(wrapped(g.phi_r - g.phi_i)));
  const bool at_pole = key(g.theta_i) == 0 || key(g.theta_r) == 0;
  return {std::llround(in_nanometres(point.wavelength) * 1e3), point.polarisation, key(g.theta_i), key(g.theta_r),
          at_pole ? 0 : dphi};
}

/// Where a plan's index stands among the points: plans count from 0 without gaps, but need not.
class PointNumbers {
 public:
  explicit PointNumbers(const std::vector<PlannedPoint>& points) : points_(points) {
    for (std::size_t n = 0; n < points.size() && is_plain_; ++n) {
      is_plain_ = points[n].index == static_cast<std::int32_t>(n);
    }
    if (is_plain_) return;
    for (std::size_t n = 0; n < points.size(); ++n) numbers_[points[n].index] = n;
  }
  /// points.size(): none.
  [[nodiscard]] std::size_t of(std::int32_t index) const {
    if (is_plain_) return std::min(static_cast<std::size_t>(index), points_.size());
    const auto found = numbers_.find(index);
    return found == numbers_.end() ? points_.size() : found->second;
  }

 private:
  const std::vector<PlannedPoint>& points_;
  bool is_plain_ = true;
  std::unordered_map<std::int32_t, std::size_t> numbers_;
};

void borrow(const ScanReadings& scan, std::vector<ReadingPair>& pairs) {
  const bool is_complete = std::ranges::all_of(
      pairs, [](const ReadingPair& pair) { return pair.sample == nullptr || pair.reference != nullptr; });
  if (is_complete) return;
  std::map<StandardPlace, const RawReading*> by_place;
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    if (pairs[n].reference != nullptr) by_place.try_emplace(place_of(scan.points[n]), pairs[n].reference);
  }
  std::unordered_map<const RawReading*, int> uses;
  for (std::size_t n = 0; n < pairs.size(); ++n) {
    ReadingPair& pair = pairs[n];
    if (pair.reference == nullptr) {
      const auto found = by_place.find(place_of(scan.points[n]));
      if (found == by_place.end()) continue;
      pair.reference = found->second;
      pair.is_borrowed = true;
    }
    if (pair.sample != nullptr) ++uses[pair.reference];
  }
  for (ReadingPair& pair : pairs) {
    if (pair.sample != nullptr && pair.reference != nullptr) pair.is_shared = uses.at(pair.reference) > 1;
  }
}

}  // namespace

std::vector<ReadingPair> pair_readings(const ScanReadings& scan) {
  const PointNumbers numbers(scan.points);
  std::vector<ReadingPair> pairs(scan.points.size());
  for (const RawReading& reading : scan.readings) {
    const bool is_sample = reading.target == Target::Sample;
    if (!reading.point_index || (!is_sample && reading.target != Target::Reference)) continue;
    const std::size_t n = numbers.of(*reading.point_index);
    if (n < pairs.size()) (is_sample ? pairs[n].sample : pairs[n].reference) = &reading;
  }
  borrow(scan, pairs);
  return pairs;
}

}  // namespace gonio::calibration
