#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/integral/hemisphere_integral.h"
#include "tests/reflectance/surfaces.h"
#include "tests/reflectance/table/tables.h"

namespace gonio::reflectance {
namespace {

// Readings that are linear where the table is linear leave nothing but the quadrature.
TEST(TableRhoDh, OfEqualReadingsIsPiTimesTheBrdf) {
  const Surface truth = surface("lambertian", {{"rho", 0.5}});
  for (const TableLayout layout : {TableLayout::Rings, TableLayout::Scattered}) {
    for (const Feature feature : {Feature::Smooth, Feature::HotSpot, Feature::Lobe}) {
      std::vector<TableReading> readings;
      for (const double theta : {0.0, 30.0, 60.0}) add_grid(readings, truth, direction_deg(theta, 0.0), {.last = 70.0});
      const TabulatedSurface t = table(readings, {.layout = layout, .feature = feature});
      for (const double theta : {0.0, 20.0, 30.0, 47.0, 80.0}) {
        const Integral rho = rho_dh(t, direction_deg(theta, 15.0), 1e-6);
        EXPECT_NEAR(rho.value, 0.5, std::max(3e-5, rho.error)) << "theta_i " << theta;
      }
    }
  }
}

// Rings so close that kinks do not count: the difference to half as many is 3e-6 or less in all cases below.
double by_dense_rings(const TabulatedSurface& t, const Direction& i) {
  double sum = 0.0;
  for (const HemisphereNode& node : gauss_rings(400, 800, RingSpacing::SqrtMu)) {
    sum += node.weight_sr * in_per_steradian(t.eval(i, node.direction));
  }
  return sum;
}

TEST(TableRhoDh, IsWhatDenseRingsFind) {
  std::vector<TableReading> readings;
  for (const double theta : {0.0, 30.0, 60.0}) add_spiral(readings, wheat(), direction_deg(theta, 0.0), 190);
  for (const Feature feature : {Feature::Smooth, Feature::HotSpot}) {
    const TabulatedSurface t = table(readings, {.feature = feature});
    for (const double theta : {30.0, 45.0}) {
      const Direction i = direction_deg(theta, 0.0);
      const Integral rho = rho_dh(t, i, 1e-5);
      EXPECT_NEAR(rho.value, by_dense_rings(t, i), 1e-5 + rho.error) << "theta_i " << theta;
      EXPECT_LE(rho.error, 1e-5);
    }
  }
}

TEST(TableRhoDh, OfTheWheatApproachesTheExactOneWithTheReadings) {
  // Mobley (2005) eq 8 for wheat at 30 deg.
  constexpr double kExact = 0.734215727909711;
  double last = 1.0;
  for (const int count : {190, 703, 2500}) {
    std::vector<TableReading> readings;
    add_spiral(readings, wheat(), direction_deg(30.0, 0.0), count);
    const Integral rho = rho_dh(table(readings), direction_deg(30.0, 0.0), 1e-5);
    const double off = std::abs(rho.value / kExact - 1.0);
    EXPECT_LT(off, 4e-4) << count << " readings";
    EXPECT_LT(off, last) << count << " readings";
    last = off;
  }
}

TEST(TableRhoDh, OfAReciprocalTableStatesAnErrorThatHolds) {
  std::vector<TableReading> readings;
  for (const double theta : {0.0, 30.0, 60.0}) add_spiral(readings, wheat(), direction_deg(theta, 0.0), 100);
  const TabulatedSurface t = table(readings, {.feature = Feature::Smooth, .reciprocal = true});
  for (const double theta : {0.0, 30.0, 50.0}) {
    const Direction i = direction_deg(theta, 0.0);
    const double dense = by_dense_rings(t, i);
    for (const double tolerance : {1e-2, 1e-3}) {
      const Integral rho = rho_dh(t, i, tolerance);
      EXPECT_LE(std::abs(rho.value - dense), rho.error + 3e-6) << "theta_i " << theta << ", asked " << tolerance;
      EXPECT_LE(rho.error, tolerance) << "theta_i " << theta;
    }
  }
}

}  // namespace
}  // namespace gonio::reflectance
