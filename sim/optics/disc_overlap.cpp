#include "sim/optics/disc_overlap.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

namespace gonio::sim {
namespace {

constexpr double kWholeTurn = 2.0 * std::numbers::pi;
constexpr int kSamples = 512;

struct Point {
  double x = 0.0;
  double y = 0.0;
};

Point point_at(const SurfaceEllipse& e, double t) {
  const double c = std::cos(e.azimuth.si());
  const double s = std::sin(e.azimuth.si());
  const double u = e.long_mm * std::cos(t);
  const double v = e.short_mm * std::sin(t);
  return {e.centre_x_mm + c * u - s * v, e.centre_y_mm + s * u + c * v};
}

// Negative inside, 0 on the rim.
double depth(const SurfaceEllipse& e, const Point& p) {
  const double c = std::cos(e.azimuth.si());
  const double s = std::sin(e.azimuth.si());
  const double dx = p.x - e.centre_x_mm;
  const double dy = p.y - e.centre_y_mm;
  const double u = (c * dx + s * dy) / e.long_mm;
  const double v = (c * dy - s * dx) / e.short_mm;
  return u * u + v * v - 1.0;
}

// Where the rim of `e` crosses that of `other`, between two parameters of different sides.
double crossing(const SurfaceEllipse& e, const SurfaceEllipse& other, double inside, double outside) {
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (inside + outside);
    (depth(other, point_at(e, middle)) < 0.0 ? inside : outside) = middle;
  }
  return 0.5 * (inside + outside);
}

// Half the line integral of x dy - y dx along the rim.
double swept(const SurfaceEllipse& e, double from, double to) {
  const Point a = point_at(e, from);
  const Point b = point_at(e, to);
  return 0.5 * (e.long_mm * e.short_mm * (to - from) + e.centre_x_mm * (b.y - a.y) - e.centre_y_mm * (b.x - a.x));
}

// Two that coincide, whatever their azimuths say (circles; opposite azimuths): their rims cross nowhere and everywhere.
bool is_same(const SurfaceEllipse& a, const SurfaceEllipse& b) {
  constexpr double kNearly = 1e-9;
  const double apart = std::hypot(a.centre_x_mm - b.centre_x_mm, a.centre_y_mm - b.centre_y_mm);
  if (apart > kNearly * a.short_mm) return false;
  for (const double t : {0.0, 0.125 * kWholeTurn, 0.25 * kWholeTurn}) {
    const Point p = point_at(a, t);
    if (std::abs(depth(b, p)) > kNearly) return false;
  }
  return true;
}

// The parts of one rim inside all the others. Of equal ellipses the first one has the rim.
double rim_integral(std::span<const SurfaceEllipse> ellipses, std::size_t own) {
  const SurfaceEllipse& e = ellipses[own];
  std::vector<double> cuts{0.0, kWholeTurn};
  for (std::size_t k = 0; k < ellipses.size(); ++k) {
    if (k == own) continue;
    if (is_same(ellipses[k], e)) {
      if (k < own) return 0.0;
      continue;
    }
    double before = depth(ellipses[k], point_at(e, 0.0));
    for (int j = 1; j <= kSamples; ++j) {
      const double from = kWholeTurn * (j - 1) / kSamples;
      const double to = kWholeTurn * j / kSamples;
      const double now = depth(ellipses[k], point_at(e, to));
      if ((before < 0.0) != (now < 0.0))
        cuts.push_back(before < 0.0 ? crossing(e, ellipses[k], from, to) : crossing(e, ellipses[k], to, from));
      before = now;
    }
  }
  std::ranges::sort(cuts);
  double sum = 0.0;
  for (std::size_t k = 1; k < cuts.size(); ++k) {
    const Point middle = point_at(e, 0.5 * (cuts[k - 1] + cuts[k]));
    const bool is_inside = std::ranges::all_of(
        ellipses, [&](const SurfaceEllipse& other) { return is_same(other, e) || depth(other, middle) < 0.0; });
    if (is_inside) sum += swept(e, cuts[k - 1], cuts[k]);
  }
  return sum;
}

}  // namespace

SurfaceEllipse footprint(Length radius, Angle theta, Angle phi) {
  return {.long_mm = in_millimetres(radius) / std::cos(theta.si()), .short_mm = in_millimetres(radius), .azimuth = phi};
}

double common_area_mm2(std::span<const SurfaceEllipse> ellipses) {
  assert(!ellipses.empty());
  double area = 0.0;
  for (std::size_t k = 0; k < ellipses.size(); ++k) area += rim_integral(ellipses, k);
  return area;
}

}  // namespace gonio::sim
