#include "calibration/background_history.h"

#include <algorithm>

#include "calibration/visit_search.h"

namespace gonio::calibration {

void BackgroundHistory::add(std::int32_t light_class, const BackgroundVisit& visit) {
  visits_[light_class].push_back(visit);
}

void BackgroundHistory::sort() {
  for (auto& [light_class, visits] : visits_) std::ranges::stable_sort(visits, {}, &BackgroundVisit::at);
}

std::optional<BackgroundLevel> BackgroundHistory::at(std::int32_t light_class, Instant when) const {
  const auto found = visits_.find(light_class);
  if (found == visits_.end()) return std::nullopt;
  const std::vector<BackgroundVisit>& visits = found->second;
  const auto next = visits.begin() + static_cast<std::ptrdiff_t>(first_not_before(visits, when));
  if (next == visits.begin()) return BackgroundLevel{.level = next->level, .after = &*next, .weight_after = 1.0};
  const BackgroundVisit& a = *(next - 1);
  if (next == visits.end()) return BackgroundLevel{.level = a.level, .before = &a};
  const double w = in_seconds(when - a.at) / in_seconds(next->at - a.at);
  return BackgroundLevel{
      .level = a.level + w * (next->level - a.level), .before = &a, .after = &*next, .weight_after = w};
}

}  // namespace gonio::calibration
