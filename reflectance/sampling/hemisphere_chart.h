#pragma once

#include <cmath>
#include <numbers>

#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// A place in the unit square onto which the hemisphere is spread: v from the horizon (0) to the normal (1), w the
/// azimuth in turns, 1/2 towards the azimuth of the chart's origin.
struct ChartPoint {
  double v = 0.0;
  double w = 0.0;
};

/// The square's map of the hemisphere. With t = tan(theta/2) = 1 - v^2: mu = v^2 (2 - v^2) / (1 + t^2), sin(theta) = 2
/// t / (1 + t^2). Towards the horizon v is sqrt(mu) (which takes the powers of mu by which many BRDFs end there),
/// towards the normal it is linear in theta (in which sqrt(mu) has a root singularity), and neither end cancels or
/// needs more than a division.
struct ChartRing {
  double mu;
  double sin_theta;
};
[[nodiscard, gnu::always_inline]] inline ChartRing chart_ring(double v) {
  const double v2 = v * v;
  const double t = (1.0 - v) * (1.0 + v);
  const double scale = 1.0 / (1.0 + t * t);
  return {.mu = v2 * (2.0 - v2) * scale, .sin_theta = 2.0 * t * scale};
}

/// dOmega / (dv dw) = 2 pi x 4 t / (1 + t^2)^2 x 2 v [sr].
[[nodiscard]] inline double chart_steradians(double v) {
  const double t = (1.0 - v) * (1.0 + v);
  const double scale = 1.0 / (1.0 + t * t);
  return 16.0 * std::numbers::pi * t * v * (scale * scale);
}

/// Where the direction lies; `origin` is the azimuth at w = 1/2. v^2 = 1 - t without the subtraction.
[[nodiscard]] inline ChartPoint chart_point(const Direction& d, Angle origin) {
  const double mu = d.mu();
  const double s = d.sin_theta();
  const double v2 = mu * (1.0 + s + mu) / ((1.0 + s) * (1.0 + mu));
  const double turns = (d.phi() - origin).si() / (2.0 * std::numbers::pi) + 0.5;
  return {.v = std::sqrt(v2), .w = turns - std::floor(turns)};
}

[[nodiscard]] inline Direction chart_direction(ChartPoint p, Angle origin) {
  const ChartRing ring = chart_ring(p.v);
  return Direction::from_cosine(ring.mu, ring.sin_theta, origin + radians(2.0 * std::numbers::pi * (p.w - 0.5)));
}

/// Cosine and sine of an angle in turns, 0 <= turns <= 1, to 2e-16: Taylor's series about the nearest quarter. Plain
/// arithmetic without branches: in a loop it becomes vector code, of the same bits.
struct TurnVector {
  double cosine;
  double sine;
};
[[nodiscard, gnu::always_inline]] inline TurnVector turn_vector(double turns) {
  const int quarter = static_cast<int>(4.0 * turns + 0.5);
  const double x = (turns - 0.25 * quarter) * (2.0 * std::numbers::pi);
  const double x2 = x * x;
  // 1/k! with alternating signs; at pi/4 the next terms are 2e-18 (sine) and 5e-17 (cosine).
  double s = -1.0 / 1307674368000.0;
  s = s * x2 + 1.0 / 6227020800.0;
  s = s * x2 - 1.0 / 39916800.0;
  s = s * x2 + 1.0 / 362880.0;
  s = s * x2 - 1.0 / 5040.0;
  s = s * x2 + 1.0 / 120.0;
  s = s * x2 - 1.0 / 6.0;
  s = x + x * (x2 * s);
  double c = 1.0 / 20922789888000.0;
  c = c * x2 - 1.0 / 87178291200.0;
  c = c * x2 + 1.0 / 479001600.0;
  c = c * x2 - 1.0 / 3628800.0;
  c = c * x2 + 1.0 / 40320.0;
  c = c * x2 - 1.0 / 720.0;
  c = c * x2 + 1.0 / 24.0;
  c = 1.0 - x2 * (0.5 - x2 * c);
  const bool is_turned = (quarter & 1) != 0;
  const double a = is_turned ? s : c;
  const double b = is_turned ? c : s;
  return {.cosine = ((quarter + 1) & 2) != 0 ? -a : a, .sine = (quarter & 2) != 0 ? -b : b};
}

}  // namespace gonio::reflectance
