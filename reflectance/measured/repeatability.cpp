#include "reflectance/measured/repeatability.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "reflectance/check/chi_square.h"
#include "reflectance/measured/common_components.h"
#include "reflectance/measured/geometry_index.h"

namespace gonio::reflectance {
namespace {

// The points of one geometry: scan and index.
struct Occurrence {
  std::size_t scan;
  std::size_t point;
};
using Occurrences = std::vector<Occurrence>;

std::vector<Occurrences> by_geometry(std::span<const MeasuredScan> scans, const CompareOptions& options) {
  std::vector<Occurrences> groups;
  GeometryIndex index(options);
  for (std::size_t s = 0; s < scans.size(); ++s) {
    for (const std::size_t k : usable_points(scans[s])) {
      const Geometry& g = scans[s].points[k].geometry;
      const DirectionPair pair{.i = incident_direction(g), .r = reflected_direction(g)};
      const auto known = index.nearest(pair);
      if (!known) {
        index.add(pair, groups.size());
        groups.emplace_back();
      }
      groups[known.value_or(groups.size() - 1)].push_back({.scan = s, .point = k});
    }
  }
  std::erase_if(groups, [](const Occurrences& group) {
    for (const Occurrence& o : group) {
      if (o.scan != group.front().scan) return false;
    }
    return true;
  });
  return groups;
}

RepeatedPoint repeated_point(std::span<const MeasuredScan> scans, const Occurrences& group) {
  const auto count = static_cast<double>(group.size());
  double mean = 0.0;
  double u2 = 0.0;
  for (const Occurrence& o : group) {
    const MeasuredPoint& p = scans[o.scan].points[o.point];
    mean += p.value.si() / count;
    u2 += p.u_random.si() * p.u_random.si() / count;
  }
  double squares = 0.0;
  for (const Occurrence& o : group) {
    const double off = scans[o.scan].points[o.point].value.si() - mean;
    squares += off * off;
  }
  return {.geometry = scans[group.front().scan].points[group.front().point].geometry,
          .count = group.size(),
          .mean = per_steradian(mean),
          .scatter = per_steradian(std::sqrt(squares / (count - 1.0))),
          .u_random = per_steradian(std::sqrt(u2))};
}

void add_offsets(std::span<const MeasuredScan> scans, const std::vector<Occurrences>& groups, Repeatability& result) {
  std::vector<double> off(scans.size(), 0.0);
  std::vector<double> size(scans.size(), 0.0);
  for (const MeasuredScan& scan : scans) result.scans.push_back({.name = scan.name});
  for (std::size_t n = 0; n < groups.size(); ++n) {
    const double mean = result.points[n].mean.si();
    for (const Occurrence& o : groups[n]) {
      off[o.scan] += scans[o.scan].points[o.point].value.si() - mean;
      size[o.scan] += std::abs(mean);
      ++result.scans[o.scan].points;
    }
  }
  for (std::size_t s = 0; s < scans.size(); ++s) {
    if (size[s] > 0.0) result.scans[s].mean_offset = off[s] / size[s];
  }
}

double pooled_relative_scatter(const std::vector<RepeatedPoint>& points) {
  double squares = 0.0;
  double freedom = 0.0;
  for (const RepeatedPoint& p : points) {
    if (std::abs(p.mean.si()) <= 3.0 * p.u_random.si()) continue;
    const double relative = p.scatter / p.mean;
    const auto dof = static_cast<double>(p.count - 1);
    squares += dof * relative * relative;
    freedom += dof;
  }
  return freedom > 0.0 ? std::sqrt(squares / freedom) : 0.0;
}

Error nothing_repeats(std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "tell how well scans repeat",
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

}  // namespace

Result<Repeatability> repeatability(std::span<const MeasuredScan> scans, const CompareOptions& options) {
  if (scans.size() < 2) return failure(nothing_repeats(fmt::format("{} scans", scans.size()), "at least two"));
  GONIO_TRY(check_tolerance(options.tolerance));
  CommonComponents components;
  std::vector<std::vector<std::uint32_t>> numbers;
  for (const MeasuredScan& scan : scans) {
    GONIO_TRY(check(scan));
    GONIO_TRY(check_random_parts(scan));
    numbers.push_back(components.add(scan));
  }
  const std::vector<Occurrences> groups = by_geometry(scans, options);
  if (groups.empty()) {
    return failure(nothing_repeats(fmt::format("no geometry that two of {} scans have", scans.size()),
                                   fmt::format("at least one within {:.6g} deg", in_degrees(options.tolerance))));
  }
  Repeatability result;
  std::vector<std::vector<GroupMember>> members;
  for (const Occurrences& group : groups) {
    result.points.push_back(repeated_point(scans, group));
    std::vector<GroupMember>& row = members.emplace_back();
    for (const Occurrence& o : group) row.push_back(group_member(scans[o.scan].points[o.point], numbers[o.scan]));
  }
  add_offsets(scans, groups, result);
  result.relative_scatter = pooled_relative_scatter(result.points);
  const Result<GroupChiSquare> chi = group_chi_square(members);
  if (!chi) return failure(chi.error());
  result.chi2 = chi->chi2;
  result.degrees_of_freedom = chi->degrees_of_freedom;
  result.p_value = chi_square_probability(chi->chi2, static_cast<double>(chi->degrees_of_freedom));
  return result;
}

}  // namespace gonio::reflectance
