#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "reflectance/surface/surface.h"
#include "reflectance/table/tabulated_surface.h"

namespace gonio::reflectance {

/// What a scan of `truth` without noise would read.
inline TableReading reading_of(const Surface& truth, const Direction& i, const Direction& r) {
  return {.geometry = geometry_of(i, r), .f = {.value = truth.eval(i, r)}};
}

inline Direction direction_deg(double theta, double phi) {
  return Direction::from_angles(degrees(theta), degrees(phi));
}

/// A grid as scans are made: theta_r from 0 to `last` in steps, phi_r over `turn_deg` in steps; the pole once.
struct ViewGrid {
  double theta_step = 5.0;
  double phi_step = 10.0;
  double last = 90.0;
  double turn_deg = 360.0;
};

inline void add_grid(std::vector<TableReading>& readings, const Surface& truth, const Direction& i,
                     const ViewGrid& grid) {
  readings.push_back(reading_of(truth, i, Direction()));
  for (double theta = grid.theta_step; theta <= grid.last + 1e-9; theta += grid.theta_step) {
    const bool is_closed = grid.turn_deg < 360.0;
    for (double phi = 0.0; phi < grid.turn_deg + (is_closed ? 1e-9 : -1e-9); phi += grid.phi_step) {
      readings.push_back(reading_of(truth, i, direction_deg(theta, phi)));
    }
  }
}

/// `count` directions of equal projected solid angle along a spiral.
inline void add_spiral(std::vector<TableReading>& readings, const Surface& truth, const Direction& i, int count) {
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int k = 0; k < count; ++k) {
    const double sin_theta = std::sqrt((k + 0.5) / count);
    const double mu = std::sqrt(1.0 - (k + 0.5) / count);
    readings.push_back(reading_of(truth, i, Direction::from_cosine(mu, sin_theta, radians(golden * k))));
  }
}

inline TabulatedSurface table(const std::vector<TableReading>& readings, const TableOptions& options = {}) {
  return TabulatedSurface::make(readings, options).value();
}

/// Interpolation error as in the scan-grid table of the physics notes: rms over the hemisphere by projected solid angle
/// over the mean, and the largest relative one where f is above 1 % of its peak.
struct InterpolationError {
  double rms = 0.0;
  double most = 0.0;
};

inline InterpolationError interpolation_error(const Surface& truth, const Surface& found, const Direction& i,
                                              double theta_limit_deg = 90.0) {
  constexpr int kSteps = 90;
  double square = 0.0;
  double mean = 0.0;
  double weights = 0.0;
  double peak = 0.0;
  std::vector<std::array<double, 2>> pairs;
  for (int a = 0; a < kSteps; ++a) {
    const double theta = (a + 0.5) / kSteps * theta_limit_deg;
    for (int b = 0; b < 2 * kSteps; ++b) {
      const Direction r = direction_deg(theta, (b + 0.37) / (2.0 * kSteps) * 360.0);
      const double t = in_per_steradian(truth.eval(i, r));
      const double f = in_per_steradian(found.eval(i, r));
      const double weight = r.mu() * r.sin_theta();
      square += weight * (f - t) * (f - t);
      mean += weight * t;
      weights += weight;
      peak = std::max(peak, t);
      pairs.push_back({t, f});
    }
  }
  InterpolationError error{.rms = std::sqrt(square / weights) / (mean / weights)};
  for (const auto& [t, f] : pairs) {
    if (t > 0.01 * peak) error.most = std::max(error.most, std::abs(f / t - 1.0));
  }
  return error;
}

}  // namespace gonio::reflectance
