#include "reflectance/table/interpolation_uncertainty.h"

#include <gtest/gtest.h>

#include "tests/reflectance/surfaces.h"
#include "tests/reflectance/table/tables.h"

namespace gonio::reflectance {
namespace {

// f = 1 + 2 theta_r^2 [rad], under three incidences alike: what a line over a step h misses in its middle is h^2 / 2.
TabulatedSurface bowl(TableLayout layout) {
  std::vector<TableReading> readings;
  for (const double theta_i : {0.0, 30.0, 60.0}) {
    for (double theta_r = 0.0; theta_r <= 80.0; theta_r += 10.0) {
      for (double phi = 0.0; phi < 360.0; phi += 10.0) {
        const Direction r = direction_deg(theta_r, phi);
        const double f = 1.0 + 2.0 * r.theta().si() * r.theta().si();
        readings.push_back({.geometry = geometry_of(direction_deg(theta_i, 0.0), r), .f = {per_steradian(f), {}}});
        if (theta_r == 0.0) break;
      }
    }
  }
  return table(readings, {.symmetry = TableSymmetry::Turn, .layout = layout, .feature = Feature::Smooth});
}

TEST(InterpolationUncertainty, IsNothingAtAReadingAndTheCurvatureBetweenThem) {
  const double missed = 0.5 * degrees(10.0).si() * degrees(10.0).si();
  for (const TableLayout layout : {TableLayout::Rings, TableLayout::Scattered}) {
    const TabulatedSurface t = bowl(layout);
    const Direction i = direction_deg(30.0, 0.0);

    EXPECT_LT(interpolation_uncertainty(t, i, direction_deg(40.0, 50.0)).si(), 1e-9);
    const double between = interpolation_uncertainty(t, i, direction_deg(45.0, 50.0)).si();
    // A triangle's neighbours see up to twice the curvature of one direction.
    EXPECT_GT(between, 0.9 * missed);
    EXPECT_LT(between, layout == TableLayout::Rings ? 1.1 * missed : 2.5 * missed);
  }
}

TEST(InterpolationUncertainty, KnowsHowFarTheIncidencesAreFromEachOther) {
  std::vector<TableReading> readings;
  for (const double theta_i : {10.0, 30.0, 50.0})
    add_grid(readings, wheat(), direction_deg(theta_i, 0.0), {.theta_step = 2.0, .phi_step = 5.0, .last = 80.0});
  const TabulatedSurface t = table(readings, {.symmetry = TableSymmetry::Turn});
  const Direction r = direction_deg(50.0, 120.0);

  const auto off_at = [&](double theta_i) {
    const Direction i = direction_deg(theta_i, 0.0);
    return std::abs((t.eval(i, r) - wheat().eval(i, r)).si());
  };

  EXPECT_LT(interpolation_uncertainty(t, direction_deg(30.0, 0.0), r).si(), 1e-4);
  for (const double theta_i : {20.0, 40.0}) {
    const double u = interpolation_uncertainty(t, direction_deg(theta_i, 0.0), r).si();
    EXPECT_LT(off_at(theta_i), 2.0 * u) << theta_i;
    EXPECT_LT(u, 0.1 * wheat().eval(direction_deg(theta_i, 0.0), r).si()) << theta_i;
  }
}

}  // namespace
}  // namespace gonio::reflectance
