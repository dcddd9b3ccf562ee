#include "calibration/offset_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace gonio::calibration {
namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;

struct Vector2 {
  double x = 0.0;
  double y = 0.0;
};

double dot(const Vector2& a, const Vector2& b) {
  return a.x * b.x + a.y * b.y;
}

double cross(const Vector2& a, const Vector2& b) {
  return a.x * b.y - a.y * b.x;
}

// An ellipse on the surface, mm: middle + first cos t + second sin t.
struct Rim {
  Vector2 middle;
  Vector2 first;
  Vector2 second;

  [[nodiscard]] Vector2 at(double t) const {
    const double c = std::cos(t);
    const double s = std::sin(t);
    return {middle.x + first.x * c + second.x * s, middle.y + first.y * c + second.y * s};
  }
  // In units of the half axes, from the middle.
  [[nodiscard]] Vector2 scaled(const Vector2& way) const {
    return {dot(way, first) / dot(first, first), dot(way, second) / dot(second, second)};
  }
};

Rim rim_of(Length radius, Angle theta, Angle phi, const Vector2& middle) {
  const double across = in_millimetres(radius);
  const double along = across / std::cos(theta.si());
  const double c = std::cos(phi.si());
  const double s = std::sin(phi.si());
  return {.middle = middle, .first = {along * c, along * s}, .second = {-across * s, across * c}};
}

// How far outside of another ellipse the points of a rim are: a0 + a1 cos t + b1 sin t + a2 cos 2t + b2 sin 2t,
// negative inside.
struct Depth {
  double a0 = 0.0;
  double a1 = 0.0;
  double b1 = 0.0;
  double a2 = 0.0;
  double b2 = 0.0;

  Depth(const Rim& rim, const Rim& other) {
    const Vector2 m = other.scaled({rim.middle.x - other.middle.x, rim.middle.y - other.middle.y});
    const Vector2 u = other.scaled(rim.first);
    const Vector2 v = other.scaled(rim.second);
    a0 = dot(m, m) - 1.0 + 0.5 * (dot(u, u) + dot(v, v));
    a1 = 2.0 * dot(m, u);
    b1 = 2.0 * dot(m, v);
    a2 = 0.5 * (dot(u, u) - dot(v, v));
    b2 = dot(u, v);
  }
  [[nodiscard]] double at(double t) const {
    const double c = std::cos(t);
    const double s = std::sin(t);
    return a0 + a1 * c + b1 * s + a2 * (c * c - s * s) + 2.0 * b2 * s * c;
  }
  [[nodiscard]] double slope(double t) const {
    return b1 * std::cos(t) - a1 * std::sin(t) + 2.0 * (b2 * std::cos(2.0 * t) - a2 * std::sin(2.0 * t));
  }
  [[nodiscard]] double steepest() const { return std::hypot(a1, b1) + 2.0 * std::hypot(a2, b2); }
  [[nodiscard]] double most_bent() const { return std::hypot(a1, b1) + 4.0 * std::hypot(a2, b2); }
  // The other ellipse is this one.
  [[nodiscard]] bool is_nowhere() const {
    constexpr double kRounding = 1e-13;
    return std::abs(a0) + std::hypot(a1, b1) + std::hypot(a2, b2) < kRounding;
  }
};

double zero_between(const Depth& depth, double low, double high) {
  const bool begins_inside = depth.at(low) < 0.0;
  constexpr int kBits = 60;
  for (int k = 0; k < kBits && low < high; ++k) {
    const double middle = 0.5 * (low + high);
    ((depth.at(middle) < 0.0) == begins_inside ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// Two zeros nearer than the narrowest interval may be missed: what lies between them has its third power as area.
void add_zeros(const Depth& depth, double low, double high, std::vector<double>& zeros) {
  constexpr double kNarrowest = 1e-6;
  const double half = 0.5 * (high - low);
  const double middle = low + half;
  if (std::abs(depth.at(middle)) > half * depth.steepest()) return;
  if (half < kNarrowest || std::abs(depth.slope(middle)) > half * depth.most_bent()) {
    if ((depth.at(low) < 0.0) != (depth.at(high) < 0.0)) zeros.push_back(zero_between(depth, low, high));
    return;
  }
  add_zeros(depth, low, middle, zeros);
  add_zeros(depth, middle, high, zeros);
}

void add_arc(const Rim& rim, double from, double to, bool is_spot, OffsetOverlap& sum) {
  const Vector2 a = rim.at(from);
  const Vector2 b = rim.at(to);
  const Vector2 way{b.x - a.x, b.y - a.y};
  sum.area_mm2 += 0.5 * (cross(rim.first, rim.second) * (to - from) + cross(rim.middle, way));
  if (!is_spot) return;
  sum.per_x += way.y;
  sum.per_y -= way.x;
}

}  // namespace

OffsetOverlap offset_overlap(const BeamDiscs& discs, const Geometry& g, const SpotPlace& spot) {
  std::vector<Rim> rims{rim_of(discs.spot_radius, g.theta_i, g.phi_i, {in_millimetres(spot.x), in_millimetres(spot.y)}),
                        rim_of(discs.field_radius, g.theta_r, g.phi_r, {})};
  if (discs.target_radius) rims.push_back(rim_of(*discs.target_radius, {}, {}, {}));
  OffsetOverlap sum;
  for (std::size_t own = 0; own < rims.size(); ++own) {
    std::vector<Depth> others;
    std::vector<double> cuts{0.0, kFullTurn};
    bool has_edge = true;
    for (std::size_t k = 0; k < rims.size(); ++k) {
      if (k == own) continue;
      const Depth depth(rims[own], rims[k]);
      if (depth.is_nowhere()) {
        has_edge = has_edge && own < k;  // of equal ones the first has the edge
        continue;
      }
      constexpr int kParts = 8;
      for (int n = 0; n < kParts; ++n) add_zeros(depth, kFullTurn * n / kParts, kFullTurn * (n + 1) / kParts, cuts);
      others.push_back(depth);
    }
    if (!has_edge) continue;
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t k = 1; k < cuts.size(); ++k) {
      const double middle = 0.5 * (cuts[k - 1] + cuts[k]);
      const bool is_inside =
          std::all_of(others.begin(), others.end(), [&](const Depth& d) { return d.at(middle) < 0.0; });
      if (is_inside) add_arc(rims[own], cuts[k - 1], cuts[k], own == 0, sum);
    }
  }
  return sum;
}

}  // namespace gonio::calibration
