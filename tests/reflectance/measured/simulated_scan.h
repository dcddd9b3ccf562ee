#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "reflectance/measured/measured_scan.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance::test {

/// The errors of a simulated instrument, k = 1; 0 leaves one out.
struct SimulatedErrors {
  double noise = 0.0035;       ///< relative, each reading's own
  double least_noise = 1e-5;   ///< [sr^-1], each reading's own
  double certificate = 0.005;  ///< relative, shared
  double limb = 0.01;          ///< relative, shared: times 1 - mu_r
  double zero_theta_r = 0.02;  ///< [deg], shared, through the slope of f
  double background = 2e-6;    ///< [sr^-1], shared
};

/// Rings of theta_r under each theta_i over half of the azimuths, one reading at the pole. Degrees.
struct SimulatedGrid {
  std::vector<double> theta_i{0, 15, 30, 45, 60};
  std::vector<double> theta_r{0, 15, 30, 45, 60, 75};
  double phi_step = 30.0;
};

inline std::vector<Geometry> geometries(const SimulatedGrid& grid) {
  std::vector<Geometry> all;
  for (const double theta_i : grid.theta_i) {
    for (const double theta_r : grid.theta_r) {
      for (double phi = 0.0; phi <= 180.0; phi += grid.phi_step) {
        all.push_back({.theta_i = degrees(theta_i), .phi_i = {}, .theta_r = degrees(theta_r), .phi_r = degrees(phi)});
        if (theta_r == 0.0) break;
      }
    }
  }
  return all;
}

/// d f / d theta_r [per rad], one-sided at the pole.
inline double slope(const Surface& surface, Geometry g) {
  constexpr double kStep = 1e-4;
  Geometry low = g;
  low.theta_r = std::max(Angle{}, g.theta_r - radians(kStep));
  g.theta_r += radians(kStep);
  return (surface.eval(g).si() - surface.eval(low).si()) / (g.theta_r - low.theta_r).si();
}

/// What an instrument with these errors makes of the surface: every shared error drawn once, every random one at each
/// reading; the uncertainties stated from the reading, as an instrument does that does not know the truth.
inline MeasuredScan simulated_scan(const Surface& truth, const std::vector<Geometry>& geometries,
                                   const SimulatedErrors& errors, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  const double certificate = normal(engine);
  const double limb = normal(engine);
  const double zero = normal(engine);
  const double background = normal(engine);
  MeasuredScan scan{
      .name = "simulated",
      .components = {
          {"certificate", "certificate"}, {"shape mode limb", "limb"}, {"zero theta_r", ""}, {"background", ""}}};
  for (const Geometry& g : geometries) {
    const double f = truth.eval(g).si();
    const double darker = 1.0 - std::cos(g.theta_r.si());
    const double per_zero = slope(truth, g) * degrees(errors.zero_theta_r).si();
    const double u = std::hypot(errors.noise * f, errors.least_noise);
    const double read = f * (1.0 + errors.certificate * certificate + errors.limb * darker * limb) + per_zero * zero +
                        errors.background * background + u * normal(engine);
    scan.points.push_back({.geometry = g,
                           .value = per_steradian(read),
                           .u_random = per_steradian(std::hypot(errors.noise * read, errors.least_noise)),
                           .shared = {{0, per_steradian(errors.certificate * read)},
                                      {1, per_steradian(errors.limb * darker * read)},
                                      {2, per_steradian(per_zero)},
                                      {3, per_steradian(errors.background)}}});
  }
  return scan;
}

/// Without any error; u_random is stated all the same.
inline MeasuredScan perfect_scan(const Surface& truth, const std::vector<Geometry>& geometries, double u = 1e-6) {
  MeasuredScan scan{.name = "perfect"};
  for (const Geometry& g : geometries) {
    scan.points.push_back({.geometry = g, .value = truth.eval(g), .u_random = per_steradian(u), .shared = {}});
  }
  return scan;
}

}  // namespace gonio::reflectance::test
