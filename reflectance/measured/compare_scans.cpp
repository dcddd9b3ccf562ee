#include "reflectance/measured/compare_scans.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "reflectance/check/chi_square.h"
#include "reflectance/measured/common_components.h"
#include "reflectance/measured/geometry_index.h"
#include "reflectance/table/interpolation_uncertainty.h"

namespace gonio::reflectance {
namespace {

DirectionPair pair_of(const MeasuredPoint& p) {
  return {.i = incident_direction(p.geometry), .r = reflected_direction(p.geometry)};
}

// What is compared: the values of each gap, side by side.
struct GapMembers {
  std::vector<std::vector<GroupMember>> groups;
  double sum_first = 0.0;
  double sum_second = 0.0;
};

void add_gap(ScanComparison& comparison, GapMembers& members, PointGap gap, GroupMember a, GroupMember b) {
  SharedEffects left = a.shared;
  left.add(b.shared, -1.0);
  const double difference = a.value - b.value;
  const double u = std::hypot(a.u_random, b.u_random, size_of(left));
  gap.difference = per_steradian(difference);
  gap.u = per_steradian(u);
  gap.z = difference / u;
  comparison.gaps.push_back(gap);
  members.sum_first += a.value;
  members.sum_second += b.value;
  members.groups.push_back({std::move(a), std::move(b)});
}

Result<ScanComparison> finished(ScanComparison comparison, const GapMembers& members) {
  const Result<GroupChiSquare> chi = group_chi_square(members.groups);
  if (!chi) return failure(chi.error());
  comparison.chi2 = chi->chi2;
  comparison.degrees_of_freedom = chi->degrees_of_freedom;
  comparison.p_value = chi_square_probability(chi->chi2, static_cast<double>(chi->degrees_of_freedom));
  if (members.sum_second != 0.0) comparison.mean_ratio = members.sum_first / members.sum_second;
  return comparison;
}

// An exact partner, as far as sums of weights go.
constexpr double kAsGoodAsExact = 1e-9;

// A scan beside what `partner` makes of each of its points; nothing is no partner.
template <class Partner>
Result<ScanComparison> compare_with(const MeasuredScan& given, Partner partner) {
  GONIO_TRY(check(given));
  GONIO_TRY(check_random_parts(given));
  const MeasuredScan scan = with_unknown_as_random(given);
  CommonComponents components;
  const std::vector<std::uint32_t> numbers = components.add(scan);
  ScanComparison comparison;
  GapMembers members;
  for (const std::size_t k : usable_points(scan)) {
    const MeasuredPoint& p = scan.points[k];
    Result<std::optional<GroupMember>> other = partner(k, p);
    if (!other) return failure(std::move(other).error());
    if (!*other) {
      ++comparison.unpaired_first;
      continue;
    }
    add_gap(comparison, members, {.first = k, .second = k, .geometry = p.geometry}, group_member(p, numbers),
            **std::move(other));
  }
  if (!comparison.gaps.empty()) return finished(std::move(comparison), members);
  return failure(
      {.code = ErrorCode::InvalidInput,
       .tried = fmt::format("compare the scan \"{}\"", scan.name),
       .seen = fmt::format("none of its {} points lies where the other was measured", comparison.unpaired_first),
       .limit = "at least one"});
}

// What a table says of each point of a scan.
class TablePartner {
 public:
  TablePartner(const MeasuredScan& scan, const TabulatedSurface& table, const MeasuredScan& readings,
               BetweenReadings between)
      : table_(table),
        between_(between),
        readings_(with_unknown_as_random(readings)),
        point_(usable_points(readings_)) {
    // The readings' own components come after those of the scan, unless both name one source.
    CommonComponents components;
    (void)components.add(scan);
    numbers_ = components.add(readings_);
  }

  std::optional<GroupMember> of(const MeasuredPoint& p) {
    const DirectionPair pair = pair_of(p);
    const TablePlace place = place_in(table_, pair.i, pair.r);
    outside_.beyond_incidences += place == TablePlace::BeyondIncidences ? 1 : 0;
    outside_.beyond_views += place == TablePlace::BeyondViews ? 1 : 0;
    outside_.in_holes += place == TablePlace::InAHole ? 1 : 0;
    if (place != TablePlace::Within) return std::nullopt;
    std::vector<ReadingShare> shares;
    (void)table_.shares(pair.i, pair.r, shares);
    GroupMember member{.value = table_.eval(pair.i, pair.r).si(), .u_random = 0.0, .shared = {}};
    double variance = 0.0;
    for (const ReadingShare& share : shares) {
      const GroupMember reading = group_member(readings_.points[point_[share.reading]], numbers_);
      variance += share.weight * share.weight * reading.u_random * reading.u_random;
      member.shared.add(reading.shared, share.weight);
    }
    u_interpolation_.push_back(between_ == BetweenReadings::Exact ? Brdf{}
                                                                  : interpolation_uncertainty(table_, pair.i, pair.r));
    member.u_random = std::hypot(kAsGoodAsExact * p.u_random.si(), std::sqrt(variance), u_interpolation_.back().si());
    return member;
  }

  // What the comparison itself cannot know of its gaps, which are those that `of` gave a partner, in that order.
  void add_told(ScanComparison& comparison) const {
    comparison.outside = outside_;
    for (std::size_t k = 0; k < comparison.gaps.size(); ++k) comparison.gaps[k].u_interpolation = u_interpolation_[k];
  }

 private:
  const TabulatedSurface& table_;
  BetweenReadings between_;
  MeasuredScan readings_;
  std::vector<std::size_t> point_;
  std::vector<std::uint32_t> numbers_;
  ScanComparison::OutsideTable outside_;
  std::vector<Brdf> u_interpolation_;
};

}  // namespace

const PointGap* ScanComparison::worst() const {
  const auto at = std::max_element(gaps.begin(), gaps.end(),
                                   [](const PointGap& a, const PointGap& b) { return std::abs(a.z) < std::abs(b.z); });
  return at == gaps.end() ? nullptr : &*at;
}

Result<ScanComparison> compare_scans(const MeasuredScan& first, const MeasuredScan& second,
                                     const CompareOptions& options) {
  GONIO_TRY(check_tolerance(options.tolerance));
  for (const MeasuredScan* scan : {&first, &second}) {
    GONIO_TRY(check(*scan));
    GONIO_TRY(check_random_parts(*scan));
  }
  CommonComponents components;
  const std::vector<std::uint32_t> numbers_first = components.add(first);
  const std::vector<std::uint32_t> numbers_second = components.add(second);
  GeometryIndex index(options);
  const std::vector<std::size_t> others = usable_points(second);
  for (const std::size_t k : others) index.add(pair_of(second.points[k]), k);
  ScanComparison comparison{.unpaired_second = others.size()};
  GapMembers members;
  for (const std::size_t k : usable_points(first)) {
    const MeasuredPoint& p = first.points[k];
    const auto partner = index.nearest(pair_of(p));
    if (!partner) {
      ++comparison.unpaired_first;
      continue;
    }
    index.take(*partner);
    --comparison.unpaired_second;
    add_gap(comparison, members, {.first = k, .second = *partner, .geometry = p.geometry},
            group_member(p, numbers_first), group_member(second.points[*partner], numbers_second));
  }
  if (!comparison.gaps.empty()) return finished(std::move(comparison), members);
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = fmt::format("compare the scans \"{}\" and \"{}\"", first.name, second.name),
                  .seen = fmt::format("no geometry of {} and {} points is common", comparison.unpaired_first,
                                      comparison.unpaired_second),
                  .limit = fmt::format("at least one within {:.6g} deg", in_degrees(options.tolerance))});
}

Result<ScanComparison> compare_with_surface(const MeasuredScan& scan, const Surface& surface) {
  return compare_with(scan, [&](std::size_t k, const MeasuredPoint& p) -> Result<std::optional<GroupMember>> {
    const double f = surface.eval(p.geometry).si();
    if (std::isfinite(f)) return GroupMember{.value = f, .u_random = kAsGoodAsExact * p.u_random.si(), .shared = {}};
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = fmt::format("compare the scan \"{}\" with a surface \"{}\"", scan.name, surface.model()),
                    .seen = fmt::format("the surface is {} /sr at point {}", f, k),
                    .limit = "a finite number"});
  });
}

Result<ScanComparison> compare_with_table(const MeasuredScan& scan, const TabulatedSurface& table,
                                          const MeasuredScan& readings, BetweenReadings between) {
  GONIO_TRY(check(readings));
  TablePartner partner(scan, table, readings, between);
  Result<ScanComparison> comparison = compare_with(
      scan, [&](std::size_t, const MeasuredPoint& p) -> Result<std::optional<GroupMember>> { return partner.of(p); });
  if (!comparison) return comparison;
  partner.add_told(*comparison);
  return comparison;
}

}  // namespace gonio::reflectance
