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
  double random2 = 0.0;
  double own2 = 0.0;
  for (const Occurrence& o : group) {
    const MeasuredPoint& p = scans[o.scan].points[o.point];
    mean += p.value.si() / count;
    random2 += p.u_random.si() * p.u_random.si() / count;
    for (const SharedEffect& e : p.shared) {
      if (scans[o.scan].components[e.component].source.empty()) own2 += e.per_sd.si() * e.per_sd.si() / count;
    }
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
          .u_random = per_steradian(std::sqrt(random2)),
          .u = per_steradian(std::sqrt(random2 + own2))};
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

// Whether a relative scatter means something there.
bool stands_out(const RepeatedPoint& p) {
  return std::abs(p.mean.si()) > 3.0 * p.u_random.si();
}

double pooled_relative_scatter(const std::vector<RepeatedPoint>& points) {
  double squares = 0.0;
  double freedom = 0.0;
  for (const RepeatedPoint& p : points) {
    if (!stands_out(p)) continue;
    const double relative = p.scatter / p.mean;
    const auto dof = static_cast<double>(p.count - 1);
    squares += dof * relative * relative;
    freedom += dof;
  }
  return freedom > 0.0 ? std::sqrt(squares / freedom) : 0.0;
}

double scatter_of_offsets(const std::vector<ScanOffset>& offsets) {
  double mean = 0.0;
  double squares = 0.0;
  const auto count = static_cast<double>(offsets.size());
  for (const ScanOffset& o : offsets) mean += o.mean_offset / count;
  for (const ScanOffset& o : offsets) squares += (o.mean_offset - mean) * (o.mean_offset - mean);
  return std::sqrt(squares / (count - 1.0));
}

// About the geometries' means with each scan's offset taken out; an offset costs a degree of freedom, but for one.
double scatter_without_offsets(std::span<const MeasuredScan> scans, const std::vector<Occurrences>& groups,
                               const Repeatability& result) {
  double squares = 0.0;
  double freedom = 1.0 - static_cast<double>(scans.size());
  for (std::size_t n = 0; n < groups.size(); ++n) {
    const RepeatedPoint& p = result.points[n];
    if (!stands_out(p)) continue;
    for (const Occurrence& o : groups[n]) {
      const double off = scans[o.scan].points[o.point].value / p.mean - 1.0 - result.scans[o.scan].mean_offset;
      squares += off * off;
    }
    freedom += static_cast<double>(p.count - 1);
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
  result.relative_between = scatter_of_offsets(result.scans);
  result.relative_within = scatter_without_offsets(scans, groups, result);
  const Result<GroupChiSquare> chi = group_chi_square(members);
  if (!chi) return failure(chi.error());
  result.chi2 = chi->chi2;
  result.degrees_of_freedom = chi->degrees_of_freedom;
  result.p_value = chi_square_probability(chi->chi2, static_cast<double>(chi->degrees_of_freedom));
  return result;
}

}  // namespace gonio::reflectance
