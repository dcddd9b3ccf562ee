#include "reflectance/table/merge_readings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>

namespace gonio::reflectance {
namespace {

using Cell = std::array<std::int64_t, 3>;

// The first direction of each group, found again by the cell of space that it lies in.
class GroupFinder {
 public:
  explicit GroupFinder(double tolerance) : tolerance_(tolerance) {}

  // The group of a direction closer than the tolerance, or a new one.
  std::size_t group_of(const Vector& r) {
    const Cell home = cell_of(r);
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        for (std::int64_t dz = -1; dz <= 1; ++dz) {
          const auto [first, last] = cells_.equal_range({home[0] + dx, home[1] + dy, home[2] + dz});
          for (auto it = first; it != last; ++it) {
            if (arc(firsts_[it->second], r) <= tolerance_) return it->second;
          }
        }
      }
    }
    cells_.emplace(home, firsts_.size());
    firsts_.push_back(r);
    return firsts_.size() - 1;
  }

 private:
  [[nodiscard]] Cell cell_of(const Vector& r) const {
    return {std::llround(r.x / tolerance_), std::llround(r.y / tolerance_), std::llround(r.z / tolerance_)};
  }

  double tolerance_;
  std::multimap<Cell, std::size_t> cells_;
  std::vector<Vector> firsts_;
};

double value_of(const PlacedReading& p) {
  return in_per_steradian(p.reading->f.value);
}

double u_of(const PlacedReading& p) {
  return in_per_steradian(p.reading->f.u);
}

TableNode node_of(std::span<const PlacedReading> group, TableReport& report, Origins& origins) {
  if (group.size() == 1) {
    origins = {{.reading = group[0].index, .weight = 1.0}};
    return {.r = group[0].r, .f = value_of(group[0]), .u = u_of(group[0])};
  }
  const bool has_u = std::all_of(group.begin(), group.end(), [](const PlacedReading& p) { return u_of(p) > 0.0; });
  const auto weight = [&](const PlacedReading& p) { return has_u ? 1.0 / (u_of(p) * u_of(p)) : 1.0; };
  double weights = 0.0;
  double sum = 0.0;
  for (const PlacedReading& p : group) {
    weights += weight(p);
    sum += weight(p) * value_of(p);
  }
  for (const PlacedReading& p : group) origins.push_back({.reading = p.index, .weight = weight(p) / weights});
  TableNode node{.r = group[0].r, .f = sum / weights};
  MergedReadings merged{.geometry = group[0].reading->geometry, .count = group.size()};
  if (has_u) {
    double chi2 = 0.0;
    for (const PlacedReading& p : group) {
      const double deviation = std::abs(value_of(p) - node.f) / u_of(p);
      merged.largest_deviation = std::max(merged.largest_deviation, deviation);
      chi2 += deviation * deviation;
    }
    merged.disagree = merged.largest_deviation > 3.0;
    const double birge = std::sqrt(chi2 / static_cast<double>(group.size() - 1));
    node.u = (merged.disagree ? std::max(1.0, birge) : 1.0) / std::sqrt(weights);
  }
  report.disagreeing += merged.disagree ? 1 : 0;
  report.merged.push_back(merged);
  return node;
}

double theta_of(const TableNode& n) {
  return std::atan2(std::hypot(n.r.x, n.r.y), n.r.z);
}

}  // namespace

MergedNodes merged_nodes(std::span<const PlacedReading> readings, double tolerance, TableReport& report) {
  GroupFinder finder(tolerance);
  std::vector<std::vector<PlacedReading>> groups;
  for (const PlacedReading& p : readings) {
    const std::size_t k = finder.group_of(p.r);
    if (k == groups.size()) groups.emplace_back();
    groups[k].push_back(p);
  }
  MergedNodes merged;
  merged.nodes.reserve(groups.size());
  merged.origins.resize(groups.size());
  for (std::size_t k = 0; k < groups.size(); ++k) {
    merged.nodes.push_back(node_of(groups[k], report, merged.origins[k]));
  }
  return merged;
}

MergedNodes profile_nodes(const MergedNodes& nodes, double tolerance) {
  std::vector<std::size_t> order(nodes.nodes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto theta_at = [&](std::size_t place) { return theta_of(nodes.nodes[order[place]]); };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return theta_of(nodes.nodes[a]) < theta_of(nodes.nodes[b]); });
  std::size_t rings = 1;
  for (std::size_t k = 1; k < order.size(); ++k) rings += theta_at(k) - theta_at(k - 1) > tolerance;
  constexpr std::size_t kManyAtOnce = 8;
  constexpr std::size_t kFewRings = 64;
  const bool has_rings = rings <= kFewRings || 2 * rings <= order.size();
  MergedNodes profile;
  for (std::size_t first = 0; first < order.size();) {
    std::size_t last = first + 1;
    while (last < order.size() &&
           (has_rings ? theta_at(last) - theta_at(last - 1) <= tolerance : last - first < kManyAtOnce)) {
      ++last;
    }
    TableNode mean;
    Origins origins;
    double theta = 0.0;
    const auto count = static_cast<double>(last - first);
    for (std::size_t k = first; k < last; ++k) {
      mean.f += nodes.nodes[order[k]].f / count;
      mean.u += nodes.nodes[order[k]].u / count;
      theta += theta_at(k) / count;
      for (const ReadingShare& share : nodes.origins[order[k]]) {
        origins.push_back({.reading = share.reading, .weight = share.weight / count});
      }
    }
    mean.r = {.x = std::sin(theta), .y = 0.0, .z = std::max(0.0, std::cos(theta))};
    profile.nodes.push_back(mean);
    profile.origins.push_back(std::move(origins));
    first = last;
  }
  return profile;
}

}  // namespace gonio::reflectance
