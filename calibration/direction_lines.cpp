#include "calibration/direction_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "calibration/key_numbers.h"

namespace gonio::calibration {
namespace {

constexpr double kHalfTurnRad = std::numbers::pi;
constexpr std::int32_t kQuarter = 90000;  // in 0.001 deg
constexpr double kBeyondAll = std::numeric_limits<double>::infinity();

struct LineKey {
  std::int64_t light = 0;
  std::int32_t fixed = 0;  // the angle that does not change along it
  std::int32_t plane = 0;  // theta: dphi of its half where theta grows; phi: the other fixed angle
  std::int32_t phi_i = 0;  // where it counts
  friend bool operator==(const LineKey&, const LineKey&) = default;
  [[nodiscard]] std::size_t hash() const { return mixed({light, fixed, plane, phi_i}); }
};

/// Stops by line, in the order in which they were added.
class Sorter {
 public:
  explicit Sorter(std::size_t stops) {
    added_.reserve(stops);
    line_of_.reserve(stops);
  }
  void add(std::uint32_t line, const LineStop& stop) {
    added_.push_back(stop);
    line_of_.push_back(line);
  }
  std::uint32_t number_of(const LineKey& key) { return lines_.number_of(key); }
  [[nodiscard]] const std::vector<LineKey>& keys() const { return lines_.keys(); }

  void sort_into(LargeArray<LineStop>& stops, LargeArray<std::uint32_t>& place) const {
    constexpr std::size_t kEnds = 2;
    const std::size_t lines = keys().size();
    std::vector<std::size_t> first(lines + 1, 0);  // the stop at infinity before each line
    for (const std::uint32_t line : line_of_) ++first[line + 1];
    for (std::size_t n = 0; n < lines; ++n) first[n + 1] += first[n] + kEnds;
    stops.assign(added_.size() + kEnds * lines, LineStop{});
    std::vector<std::size_t> next(lines);
    for (std::size_t n = 0; n < lines; ++n) next[n] = first[n] + 1;
    for (std::size_t n = 0; n < added_.size(); ++n) stops[next[line_of_[n]]++] = added_[n];
    for (std::size_t n = 0; n < lines; ++n) {
      stops[first[n]].coordinate = -kBeyondAll;
      stops[first[n + 1] - 1].coordinate = kBeyondAll;
      sort_line(std::span(stops).subspan(first[n] + 1, first[n + 1] - first[n] - kEnds));
    }
    for (std::size_t n = 0; n < stops.size(); ++n) {
      const LineStop& stop = stops[n];
      if (stop.point != LineStop::kNobody && !stop.is_image) place[stop.point] = static_cast<std::uint32_t>(n);
    }
  }

 private:
  static void sort_line(std::span<LineStop> line) {
    const auto is_before = [](const LineStop& a, const LineStop& b) { return a.coordinate < b.coordinate; };
    if (!std::is_sorted(line.begin(), line.end(), is_before)) std::stable_sort(line.begin(), line.end(), is_before);
  }

  KeyNumbers<LineKey> lines_;
  LargeArray<LineStop> added_;
  LargeArray<std::uint32_t> line_of_;
};

/// Sorts points into lines along one of the thetas.
class ThetaSorter {
 public:
  ThetaSorter(std::span<const SlopePoint> points, std::span<const DirectionKey> keys, bool isotropic,
              DirectionAxis axis, Sorter& sorter)
      : points_(points), keys_(keys), isotropic_(isotropic), moves_i_(axis == DirectionAxis::ThetaI), sorter_(sorter) {
    for (std::size_t n = 0; n < points.size(); ++n) add(static_cast<std::uint32_t>(n));
    add_poles();
  }

 private:
  [[nodiscard]] double moving(std::size_t n) const {
    const Geometry& g = points_[n].reported;
    return (moves_i_ ? g.theta_i : g.theta_r).si();
  }

  void add(std::uint32_t n) {
    const DirectionKey& key = keys_[n];
    const std::int32_t d = key.dphi;
    const std::int32_t fixed = moves_i_ ? key.theta_r : key.theta_i;
    const bool other_at_pole = fixed == 0;
    // The opposite half plane: dphi + 180 deg; mirrored, 180 deg - dphi.
    const bool against = isotropic_ ? d > kQuarter : d > kQuarter || d <= -kQuarter;
    std::int32_t plane = against ? (d > 0 ? d - 2 * kQuarter : d + 2 * kQuarter) : d;
    if (isotropic_) plane = against ? 2 * kQuarter - d : d;
    if (isotropic_ && other_at_pole) plane = 0;
    const std::int8_t sign = against && !(isotropic_ && other_at_pole) ? -1 : 1;
    const LineKey own{.light = key.light, .fixed = fixed, .plane = plane, .phi_i = isotropic_ ? 0 : key.phi_i};
    const std::uint32_t line = sorter_.number_of(own);
    const double theta = moving(n);
    sorter_.add(line, {.coordinate = sign * theta, .point = n, .sign = sign, .is_image = false});
    const bool is_pole = (moves_i_ ? key.theta_i : key.theta_r) == 0;
    if (is_pole) poles_.emplace_back(own, n);
    // A plane that is its own mirror image continues beyond the normal as it came.
    const bool is_even = isotropic_ && (other_at_pole || plane == kQuarter);
    if (is_even && !is_pole) {
      const auto turned = static_cast<std::int8_t>(-sign);
      sorter_.add(line, {.coordinate = turned * theta, .point = n, .sign = turned, .is_image = true});
    }
  }

  // A point at the normal lies on every line through it.
  void add_poles() {
    if (poles_.empty()) return;
    const auto without_plane = [](LineKey key) {
      key.plane = 0;
      return key;
    };
    const std::vector<LineKey> lines = sorter_.keys();
    KeyNumbers<LineKey> pencils;
    std::vector<std::vector<std::uint32_t>> through;
    for (std::size_t line = 0; line < lines.size(); ++line) {
      const std::uint32_t pencil = pencils.number_of(without_plane(lines[line]));
      if (pencil == through.size()) through.emplace_back();
      through[pencil].push_back(static_cast<std::uint32_t>(line));
    }
    for (const auto& [own, n] : poles_) {
      for (const std::uint32_t line : through[pencils.number_of(without_plane(own))]) {
        if (lines[line].plane == own.plane) continue;
        sorter_.add(line, {.coordinate = moving(n), .point = n, .sign = 1, .is_image = true});
      }
    }
  }

  std::span<const SlopePoint> points_;
  std::span<const DirectionKey> keys_;
  bool isotropic_;
  bool moves_i_;
  Sorter& sorter_;
  std::vector<std::pair<LineKey, std::uint32_t>> poles_;
};

/// Sorts points into lines along phi. Their images stand where phi goes round, an isotropic sample's in the mirror
/// plane: those that no point of the line itself could reach are left out.
class PhiSorter {
 public:
  PhiSorter(bool isotropic, Sorter& sorter) : isotropic_(isotropic), sorter_(sorter) {}

  void add(std::uint32_t n, const SlopePoint& p, const DirectionKey& key) {
    const std::uint32_t line = sorter_.number_of(
        {.light = key.light, .fixed = key.theta_i, .plane = key.theta_r, .phi_i = isotropic_ ? 0 : key.phi_i});
    const Angle dphi = wrapped(p.reported.phi_r - p.reported.phi_i);
    // An isotropic sample's own angle is |dphi|: where phi_r - phi_i is negative it grows against it.
    const std::int8_t sign = isotropic_ && dphi < Angle{} ? -1 : 1;
    const double d = isotropic_ ? std::abs(dphi.si()) : dphi.si();
    sorter_.add(line, {.coordinate = d, .point = n, .sign = sign, .is_image = false});
    if (isotropic_) {
      const auto turned = static_cast<std::int8_t>(-sign);
      add_image(line, {.coordinate = -d, .point = n, .sign = turned, .is_image = true});
      add_image(line, {.coordinate = 2.0 * kHalfTurnRad - d, .point = n, .sign = turned, .is_image = true});
    } else {
      add_image(line, {.coordinate = d + 2.0 * kHalfTurnRad, .point = n, .sign = sign, .is_image = true});
      add_image(line, {.coordinate = d - 2.0 * kHalfTurnRad, .point = n, .sign = sign, .is_image = true});
    }
  }

 private:
  void add_image(std::uint32_t line, const LineStop& image) {
    const double first = isotropic_ ? 0.0 : -kHalfTurnRad;
    const bool is_near = image.coordinate >= first - kFarthestStop && image.coordinate <= kHalfTurnRad + kFarthestStop;
    if (is_near) sorter_.add(line, image);
  }

  bool isotropic_;
  Sorter& sorter_;
};

}  // namespace

std::int64_t plan_key(Angle a) {
  return std::llround(in_degrees(a) * 1e3);
}

Angle azimuth_between(const Geometry& g, bool isotropic) {
  const Angle d = wrapped(g.phi_r - g.phi_i);
  return isotropic && d < Angle{} ? -d : d;
}

DirectionKey direction_key(const SlopePoint& point, bool isotropic) {
  const Geometry& g = point.planned;
  const auto key = [](Angle a) { return static_cast<std::int32_t>(plan_key(a)); };
  return {.light = std::llround(in_nanometres(point.wavelength) * 1e3) * 4 + point.state,
          .theta_i = key(g.theta_i),
          .theta_r = key(g.theta_r),
          .phi_i = key(g.phi_i),
          .dphi = key(azimuth_between(g, isotropic))};
}

DirectionLines::DirectionLines(std::span<const SlopePoint> points, std::span<const DirectionKey> keys, bool isotropic,
                               DirectionAxis axis)
    : place_(points.size()) {
  Sorter sorter(2 * points.size());  // phi lines have images of half of their points, few others any
  if (axis == DirectionAxis::PhiR) {
    PhiSorter phi(isotropic, sorter);
    for (std::size_t n = 0; n < points.size(); ++n) phi.add(static_cast<std::uint32_t>(n), points[n], keys[n]);
  } else {
    ThetaSorter(points, keys, isotropic, axis, sorter);
  }
  sorter.sort_into(stops_, place_);
}

}  // namespace gonio::calibration
