#include "calibration/overlap.h"

#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

namespace gonio::calibration {
namespace {

constexpr double kHalfCircle = std::numbers::pi;

// 1 / r^2 = a + b cos(2 phi) + c sin(2 phi), in mm^-2.
struct InverseSquare {
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
  double inverse_axes = 0.0;  // 1 / (product of the half axes)
  [[nodiscard]] double at(double cos_2phi, double sin_2phi) const { return a + b * cos_2phi + c * sin_2phi; }
};

InverseSquare ellipse(Length radius, Angle theta, Angle phi) {
  const double across = 1.0 / (in_millimetres(radius) * in_millimetres(radius));
  const double mu = std::cos(theta.si());
  assert(mu > 0.0);
  const double half_change = -0.5 * std::pow(std::sin(theta.si()), 2) * across;
  return {.a = 0.5 * (1.0 + mu * mu) * across,
          .b = half_change * std::cos(2.0 * phi.si()),
          .c = half_change * std::sin(2.0 * phi.si()),
          .inverse_axes = mu * across};
}

struct Shapes {
  std::array<InverseSquare, 3> of{};  // spot, field, target
  std::size_t count = 2;
};

Shapes shapes_of(const BeamDiscs& discs, const Geometry& g) {
  Shapes shapes;
  shapes.of[0] = ellipse(discs.spot_radius, g.theta_i, g.phi_i);
  shapes.of[1] = ellipse(discs.field_radius, g.theta_r, g.phi_r);
  if (discs.target_radius) shapes.of[shapes.count++] = ellipse(*discs.target_radius, {}, {});
  return shapes;
}

// Doubled azimuths in [0, 2 pi) at which two edges cross, ascending: of each two edges none or two.
struct Cuts {
  std::array<double, 7> at{};
  std::size_t count = 0;
  void add(double doubled) {
    const double turns = doubled / (2.0 * kHalfCircle);
    const double within = 2.0 * kHalfCircle * (turns - std::floor(turns));
    std::size_t place = count++;
    for (; place > 0 && at[place - 1] > within; --place) at[place] = at[place - 1];
    at[place] = within;
  }
};

void add_crossings(const InverseSquare& k, const InverseSquare& l, Cuts& cuts) {
  const double a = k.a - l.a;
  const double b = k.b - l.b;
  const double c = k.c - l.c;
  const double most = std::hypot(b, c);
  if (most <= std::abs(a)) return;
  const double middle = std::atan2(c, b);
  const double away = std::acos(-a / most);
  cuts.add(middle + away);
  cuts.add(middle - away);
}

std::size_t nearest(const Shapes& shapes, double cos_u, double sin_u) {
  std::size_t found = 0;
  for (std::size_t k = 1; k < shapes.count; ++k) {
    if (shapes.of[k].at(cos_u, sin_u) > shapes.of[found].at(cos_u, sin_u)) found = k;
  }
  return found;
}

// The sector of one ellipse between two doubled azimuths, and the integrals of 1 / r^2 of spot and field over it. With
// the eccentric anomaly t a point of the edge is p (cos t, sin t) in scaled axes: any quadratic form of it goes as
// alpha + beta cos 2t + gamma sin 2t.
class Sector {
 public:
  Sector(const InverseSquare& own, double from, double to) : own_(own) {
    const double half = 0.5 * (to - from);
    const double middle = 0.5 * (to + from);
    const double cos_m = std::cos(middle);
    const double sin_m = std::sin(middle);
    change_ = std::atan2(std::sin(half) * own.inverse_axes, own.a * std::cos(half) + own.b * cos_m + own.c * sin_m);
    first_ = from;
  }
  [[nodiscard]] double area() const { return change_ / own_.inverse_axes; }  // of both halves of the turn
  // Mean over the sector of x^T Q x: that of the edge's points in t, halved by the integral along the radius.
  [[nodiscard]] double mean_of(const InverseSquare& q) const {
    const double axis = std::atan2(own_.c, own_.b);  // doubled azimuth of the short axis
    const double swing = std::hypot(own_.b, own_.c);
    const double short2 = 1.0 / (own_.a + swing);  // squared half axes
    const double long2 = 1.0 / (own_.inverse_axes * own_.inverse_axes * short2);
    const double along = 0.5 * (first_ - axis);  // azimuth from the short axis
    const double t = std::atan2(std::sin(along) / std::sqrt(long2), std::cos(along) / std::sqrt(short2));
    const double even = q.b * std::cos(axis) + q.c * std::sin(axis);
    const double odd = q.c * std::cos(axis) - q.b * std::sin(axis);
    const double xx = short2 * (q.a + even);
    const double yy = long2 * (q.a - even);
    const double xy = std::sqrt(short2 * long2) * odd;
    const double turned = 0.5 * (std::sin(2.0 * (t + change_)) - std::sin(2.0 * t));
    const double turned_odd = -0.5 * (std::cos(2.0 * (t + change_)) - std::cos(2.0 * t));
    const double sum = 0.5 * (xx + yy) * change_ + 0.5 * (xx - yy) * turned + xy * turned_odd;
    return change_ == 0.0 ? 0.0 : 0.5 * sum / change_;
  }

 private:
  const InverseSquare& own_;
  double change_ = 0.0;
  double first_ = 0.0;
};

// Whether `inner`, grown, lies within `outer`.
bool is_within(const InverseSquare& inner, const InverseSquare& outer, double margin) {
  const double shrunk = 1.0 / ((1.0 + margin) * (1.0 + margin));
  const double a = inner.a * shrunk - outer.a;
  return a >= std::hypot(inner.b * shrunk - outer.b, inner.c * shrunk - outer.c);
}

}  // namespace

Overlap overlap_of(const BeamDiscs& discs, const Geometry& g) {
  const Shapes shapes = shapes_of(discs, g);
  Cuts cuts;
  for (std::size_t k = 0; k < shapes.count; ++k) {
    for (std::size_t l = k + 1; l < shapes.count; ++l) add_crossings(shapes.of[k], shapes.of[l], cuts);
  }
  if (cuts.count == 0) cuts.add(0.0);
  cuts.at[cuts.count] = cuts.at[0] + 2.0 * kHalfCircle;
  Overlap sum;
  std::array<double, 3> parts{};
  for (std::size_t k = 0; k < cuts.count; ++k) {
    const double middle = 0.5 * (cuts.at[k] + cuts.at[k + 1]);
    const std::size_t own = nearest(shapes, std::cos(middle), std::sin(middle));
    const Sector sector(shapes.of[own], cuts.at[k], cuts.at[k + 1]);
    const double area = sector.area();
    parts[own] += area;
    sum.area_mm2 += area;
    sum.spot_mean_square += area * sector.mean_of(shapes.of[0]);
    sum.field_mean_square += area * sector.mean_of(shapes.of[1]);
  }
  sum.spot_mean_square /= sum.area_mm2;
  sum.field_mean_square /= sum.area_mm2;
  sum.by_spot = 2.0 * parts[0] / sum.area_mm2;
  sum.by_field = 2.0 * parts[1] / sum.area_mm2;
  sum.by_target = 2.0 * parts[2] / sum.area_mm2;
  return sum;
}

BeamMode beam_mode(const BeamDiscs& discs, const Geometry& g, double margin) {
  const Shapes shapes = shapes_of(discs, g);
  const auto lies_within = [&](std::size_t inner, std::size_t outer) {
    return is_within(shapes.of[inner], shapes.of[outer], margin) &&
           (shapes.count == 2 || is_within(shapes.of[inner], shapes.of[2], margin));
  };
  if (lies_within(1, 0)) return BeamMode::Radiance;
  return lies_within(0, 1) ? BeamMode::Intensity : BeamMode::Mixed;
}

}  // namespace gonio::calibration
