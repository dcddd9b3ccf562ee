#include "daemon/planner/exposure_ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gonio::daemon {

namespace {

constexpr double kSameRung = 0.01;  // relative; the next one is a factor of two away

std::string beside(Duration exposure, const std::vector<Duration>& ladder) {
  const auto above = std::ranges::upper_bound(ladder, exposure);
  if (above == ladder.begin()) return fmt::format("{} s or longer", in_seconds(ladder.front()));
  if (above == ladder.end()) return fmt::format("{} s or shorter", in_seconds(ladder.back()));
  return fmt::format("{} s or {} s", in_seconds(*std::prev(above)), in_seconds(*above));
}

}  // namespace

std::vector<Duration> exposure_ladder(const DetectorConfig& detector, Duration max_time) {
  if (detector.power) return std::vector<Duration>(detector.power->ranges_w.size(), detector.power->reading_time());
  const Duration longest = std::min(detector.longest_exposure, max_time);
  std::vector<Duration> ladder;
  Duration exposure = detector.shortest_exposure;
  do {
    ladder.push_back(exposure);
    exposure *= 2;
  } while (exposure <= longest);
  return ladder;
}

Result<std::vector<std::size_t>> rungs_of(const std::vector<Duration>& exposures, const std::vector<Duration>& ladder) {
  std::vector<std::size_t> rungs;
  for (const Duration exposure : exposures) {
    const auto same = std::ranges::find_if(ladder, [exposure](Duration rung) {
      return std::abs(in_seconds(exposure) / in_seconds(rung) - 1.0) < kSameRung;
    });
    if (same == ladder.end()) {
      return failure(Error{.code = ErrorCode::InvalidInput,
                           .device = "plan",
                           .tried = "find the detector's exposure for a stated one",
                           .seen = fmt::format("{} s", in_seconds(exposure)),
                           .limit = beside(exposure, ladder),
                           .where = InputLocation{.field = "reading.exposure_s"}});
    }
    rungs.push_back(static_cast<std::size_t>(std::distance(ladder.begin(), same)));
  }
  return rungs;
}

}  // namespace gonio::daemon
