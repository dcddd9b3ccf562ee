#include "reflectance/check/symmetry_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "reflectance/check/chi_square.h"
#include "reflectance/check/group_chi_square.h"
#include "reflectance/check/shared_effects.h"

namespace gonio::reflectance {
namespace {

Error bad_number(std::size_t k, const char* name, double value, const char* limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = fmt::format("check the symmetry of point {}", k),
          .seen = fmt::format("{} {} /sr", name, value),
          .limit = limit};
}

// Squares of ratios of such numbers, and their sums, stay finite.
constexpr double kLargest = 1e50;
constexpr double kSmallest = 1e-50;

Result<void> check_numbers(std::span<const SymmetryPoint> points) {
  constexpr const char* kRange = "-1e50 to 1e50 /sr";
  const auto is_fit = [](double x) { return std::abs(x) <= kLargest; };  // false for NaN
  for (std::size_t k = 0; k < points.size(); ++k) {
    const SymmetryPoint& p = points[k];
    const double u = p.u_random.si();
    if (!is_fit(p.value.si())) return failure(bad_number(k, "value", p.value.si(), kRange));
    if (!is_fit(u) || u < kSmallest) return failure(bad_number(k, "u_random", u, "1e-50 to 1e50 /sr"));
    for (const SharedEffect& e : p.shared) {
      if (!is_fit(e.per_sd.si())) return failure(bad_number(k, "a shared effect", e.per_sd.si(), kRange));
    }
  }
  return {};
}

GroupMember member_of(const SymmetryPoint& p) {
  return {.value = p.value.si(), .u_random = p.u_random.si(), .shared = SharedEffects(p.shared)};
}

SymmetryGap gap_between(std::size_t first, std::size_t second, const GroupMember& a, const GroupMember& b) {
  SharedEffects left = a.shared;
  left.add(b.shared, -1.0);
  const double difference = a.value - b.value;
  const double u = std::hypot(a.u_random, b.u_random, size_of(left));
  return {.first = first,
          .second = second,
          .difference = per_steradian(difference),
          .u = per_steradian(u),
          .z = difference / u};
}

}  // namespace

const SymmetryGap* SymmetryReport::worst() const {
  const auto by_z = [](const SymmetryGap& a, const SymmetryGap& b) { return std::abs(a.z) < std::abs(b.z); };
  const auto at = std::max_element(gaps.begin(), gaps.end(), by_z);
  return at == gaps.end() ? nullptr : &*at;
}

Result<SymmetryReport> check_symmetry(Symmetry symmetry, std::span<const SymmetryPoint> points,
                                      const SymmetryOptions& options) {
  GONIO_TRY(check_numbers(points));
  const Result<SymmetryGroups> found = find_symmetry_groups(symmetry, points, options);
  if (!found) return failure(found.error());
  SymmetryReport report{.unpaired = found->unpaired, .trivial = found->trivial, .repeated = found->repeated};
  std::vector<std::vector<GroupMember>> groups;
  for (const std::vector<std::size_t>& indices : found->groups) {
    std::vector<GroupMember>& group = groups.emplace_back();
    for (const std::size_t k : indices) group.push_back(member_of(points[k]));
    for (std::size_t m = 1; m < group.size(); ++m) {
      report.gaps.push_back(gap_between(indices.front(), indices[m], group.front(), group[m]));
    }
  }
  const Result<GroupChiSquare> chi = group_chi_square(groups);
  if (!chi) return failure(chi.error());
  report.chi2 = chi->chi2;
  report.degrees_of_freedom = chi->degrees_of_freedom;
  if (report.degrees_of_freedom > 0) {
    report.p_value = chi_square_probability(report.chi2, static_cast<double>(report.degrees_of_freedom));
  }
  return report;
}

}  // namespace gonio::reflectance
