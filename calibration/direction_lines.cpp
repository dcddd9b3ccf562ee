#include "calibration/direction_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <unordered_map>
#include <utility>

namespace gonio::calibration {
namespace {

constexpr double kHalfTurnRad = std::numbers::pi;
constexpr std::int64_t kQuarter = 90000;  // in 0.001 deg

/// wavelength and state, the two fixed angles, phi_i where it counts.
using LineKey = std::array<std::int64_t, 4>;

struct LineKeyHash {
  std::size_t operator()(const LineKey& key) const {
    std::uint64_t z = 0;
    for (const std::int64_t part : key) {  // SplitMix64's steps (Steele, Lea and Flood 2014)
      z = (z ^ static_cast<std::uint64_t>(part)) * 0xBF58476D1CE4E5B9ULL;
      z ^= z >> 29U;
    }
    return z;
  }
};

std::int64_t light_key(const SlopePoint& p) {
  return std::llround(in_nanometres(p.wavelength) * 1e3) * 4 + p.state;
}

/// Stops by line, in the order in which they were added.
class Sorter {
 public:
  explicit Sorter(std::size_t stops) {
    added_.reserve(stops);
    line_of_.reserve(stops);
  }
  void add(const LineKey& key, const LineStop& stop) { add(number_of(key), stop); }
  void add(std::uint32_t line, const LineStop& stop) {
    added_.push_back(stop);
    line_of_.push_back(line);
  }
  std::uint32_t number_of(const LineKey& key) {
    if (!keys_.empty() && keys_[last_] == key) return last_;  // neighbours in a plan lie on one line
    const auto [entry, is_new] = numbers_.try_emplace(key, static_cast<std::uint32_t>(keys_.size()));
    if (is_new) keys_.push_back(key);
    return last_ = entry->second;
  }
  [[nodiscard]] const std::vector<LineKey>& keys() const { return keys_; }

  void sort_into(std::vector<LineStop>& stops, std::vector<std::size_t>& first) const {
    first.assign(keys_.size() + 1, 0);
    for (const std::uint32_t line : line_of_) ++first[line + 1];
    for (std::size_t n = 1; n < first.size(); ++n) first[n] += first[n - 1];
    stops.resize(added_.size());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t n = 0; n < added_.size(); ++n) stops[next[line_of_[n]]++] = added_[n];
    const auto at = [&](std::size_t n) { return stops.begin() + static_cast<std::ptrdiff_t>(n); };
    for (std::size_t n = 0; n + 1 < first.size(); ++n) {
      std::stable_sort(at(first[n]), at(first[n + 1]),
                       [](const LineStop& a, const LineStop& b) { return a.coordinate < b.coordinate; });
    }
  }

 private:
  std::unordered_map<LineKey, std::uint32_t, LineKeyHash> numbers_;
  std::vector<LineKey> keys_;
  std::uint32_t last_ = 0;
  std::vector<LineStop> added_;
  std::vector<std::uint32_t> line_of_;
};

/// Sorts points into lines along one of the thetas.
class ThetaSorter {
 public:
  ThetaSorter(std::span<const SlopePoint> points, bool isotropic, DirectionAxis axis, Sorter& sorter)
      : points_(points), isotropic_(isotropic), moves_i_(axis == DirectionAxis::ThetaI), sorter_(sorter) {
    for (std::size_t n = 0; n < points.size(); ++n) add(static_cast<std::uint32_t>(n));
    add_poles();
  }

 private:
  [[nodiscard]] Angle moving(const Geometry& g) const { return moves_i_ ? g.theta_i : g.theta_r; }
  [[nodiscard]] Angle fixed(const Geometry& g) const { return moves_i_ ? g.theta_r : g.theta_i; }

  void add(std::uint32_t n) {
    const SlopePoint& p = points_[n];
    const std::int64_t d = plan_key(azimuth_between(p.planned, isotropic_));
    const double theta = moving(p.reported).si();
    const bool other_at_pole = plan_key(fixed(p.planned)) == 0;
    // The opposite half plane: dphi + 180 deg; mirrored, 180 deg - dphi.
    const bool against = isotropic_ ? d > kQuarter : d > kQuarter || d <= -kQuarter;
    std::int64_t plane = against ? (d > 0 ? d - 2 * kQuarter : d + 2 * kQuarter) : d;
    if (isotropic_) plane = against ? 2 * kQuarter - d : d;
    if (isotropic_ && other_at_pole) plane = 0;
    const float sign = against && !(isotropic_ && other_at_pole) ? -1.0F : 1.0F;
    const LineKey key{light_key(p), plan_key(fixed(p.planned)), plane, isotropic_ ? 0 : plan_key(p.planned.phi_i)};
    const std::uint32_t line = sorter_.number_of(key);
    sorter_.add(line, {static_cast<double>(sign) * theta, n, sign, false});
    const bool is_pole = plan_key(moving(p.planned)) == 0;
    if (is_pole) poles_.emplace_back(key, n);
    // A plane that is its own mirror image continues beyond the normal as it came.
    const bool is_even = isotropic_ && (other_at_pole || plane == kQuarter);
    if (is_even && !is_pole) sorter_.add(line, {-static_cast<double>(sign) * theta, n, -sign, true});
  }

  // A point at the normal lies on every line through it.
  void add_poles() {
    if (poles_.empty()) return;
    std::unordered_map<LineKey, std::vector<std::uint32_t>, LineKeyHash> through;  // without the plane
    const std::vector<LineKey> keys = sorter_.keys();
    for (std::size_t line = 0; line < keys.size(); ++line) {
      through[{keys[line][0], keys[line][1], 0, keys[line][3]}].push_back(static_cast<std::uint32_t>(line));
    }
    for (const auto& [own, n] : poles_) {
      for (const std::uint32_t line : through[{own[0], own[1], 0, own[3]}]) {
        if (keys[line][2] != own[2]) sorter_.add(line, {moving(points_[n].reported).si(), n, 1.0F, true});
      }
    }
  }

  std::span<const SlopePoint> points_;
  bool isotropic_;
  bool moves_i_;
  Sorter& sorter_;
  std::vector<std::pair<LineKey, std::uint32_t>> poles_;
};

void sort_phi_lines(std::span<const SlopePoint> points, bool isotropic, Sorter& sorter) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto n = static_cast<std::uint32_t>(k);
    const SlopePoint& p = points[k];
    const Geometry& g = p.planned;
    const double d = azimuth_between(p.reported, isotropic).si();
    const std::uint32_t line =
        sorter.number_of({light_key(p), plan_key(g.theta_i), plan_key(g.theta_r), isotropic ? 0 : plan_key(g.phi_i)});
    // An isotropic sample's own angle is |dphi|: where phi_r - phi_i is negative it grows against it.
    const float sign = isotropic && wrapped(p.reported.phi_r - p.reported.phi_i) < Angle{} ? -1.0F : 1.0F;
    sorter.add(line, {d, n, sign, false});
    if (isotropic) {
      sorter.add(line, {-d, n, -sign, true});
      sorter.add(line, {2.0 * kHalfTurnRad - d, n, -sign, true});
    } else {
      sorter.add(line, {d + 2.0 * kHalfTurnRad, n, sign, true});
      sorter.add(line, {d - 2.0 * kHalfTurnRad, n, sign, true});
    }
  }
}

}  // namespace

std::int64_t plan_key(Angle a) {
  return std::llround(in_degrees(a) * 1e3);
}

Angle azimuth_between(const Geometry& g, bool isotropic) {
  const Angle d = wrapped(g.phi_r - g.phi_i);
  return isotropic && d < Angle{} ? -d : d;
}

DirectionLines::DirectionLines(std::span<const SlopePoint> points, bool isotropic, DirectionAxis axis) {
  constexpr std::size_t kImages = 2;  // of a point on a phi line
  Sorter sorter(points.size() * (axis == DirectionAxis::PhiR ? 1 + kImages : 2));
  if (axis == DirectionAxis::PhiR) {
    sort_phi_lines(points, isotropic, sorter);
  } else {
    ThetaSorter(points, isotropic, axis, sorter);
  }
  sorter.sort_into(stops_, first_);
}

}  // namespace gonio::calibration
