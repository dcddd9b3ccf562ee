#include "reflectance/measured/common_components.h"

#include <utility>

#include <fmt/format.h>

namespace gonio::reflectance {

std::vector<std::uint32_t> CommonComponents::add(const MeasuredScan& scan) {
  std::vector<std::uint32_t> numbers;
  for (const ScanComponent& component : scan.components) {
    if (component.source.empty()) {
      numbers.push_back(next_++);
      continue;
    }
    const auto [entry, is_new] = by_source_.try_emplace(component.source, next_);
    next_ += is_new ? 1 : 0;
    numbers.push_back(entry->second);
  }
  return numbers;
}

GroupMember group_member(const MeasuredPoint& point, const std::vector<std::uint32_t>& numbers) {
  std::vector<SharedEffect> shared = point.shared;
  for (SharedEffect& e : shared) e.component = numbers[e.component];
  return {.value = point.value.si(), .u_random = point.u_random.si(), .shared = SharedEffects(shared)};
}

Result<void> check_random_parts(const MeasuredScan& scan) {
  for (const std::size_t k : usable_points(scan)) {
    if (scan.points[k].u_random > Brdf{}) continue;
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = fmt::format("compare the scan \"{}\"", scan.name),
                    .seen = fmt::format("point {}: u_random 0 /sr", k),
                    .limit = "above 0"});
  }
  return {};
}

Result<void> check_tolerance(Angle tolerance) {
  if (tolerance >= Angle{} && tolerance <= degrees(5.0)) return {};
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = "compare scans",
                  .seen = fmt::format("a tolerance of {:.6g} deg", in_degrees(tolerance)),
                  .limit = "0 to 5 deg"});
}

}  // namespace gonio::reflectance
