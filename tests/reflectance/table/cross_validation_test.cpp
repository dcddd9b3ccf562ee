#include "reflectance/table/cross_validation.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/reflectance/surfaces.h"
#include "tests/reflectance/table/tables.h"

namespace gonio::reflectance {
namespace {

TEST(CrossValidation, SeesNoErrorWhereInterpolationMakesNone) {
  const Surface truth = surface("lambertian", {{"rho", 0.5}});
  for (const TableLayout layout : {TableLayout::Rings, TableLayout::Scattered}) {
    std::vector<TableReading> readings;
    for (const double theta : {0.0, 30.0, 60.0}) add_grid(readings, truth, direction_deg(theta, 0.0), {.last = 80.0});
    const TabulatedSurface t = table(readings, {.layout = layout});
    for (const CrossValidation& found : {cross_validate_views(t), cross_validate_incidences(t), compare_both_ways(t)}) {
      EXPECT_GT(found.count, 200u);
      EXPECT_LT(found.most.si(), 1e-14);
      EXPECT_NEAR(found.mean.si(), 0.5 / 3.14159265358979, 1e-12);
    }
  }
}

TEST(CrossValidation, NamesTheReadingThatIsOff) {
  std::vector<TableReading> readings;
  add_spiral(readings, wheat(), direction_deg(30.0, 0.0), 400);
  readings[137].f.value += per_steradian(0.5);
  const CrossValidation found = cross_validate_views(table(readings, {.symmetry = TableSymmetry::Turn}));
  EXPECT_NEAR(found.most.si(), 0.5, 0.02);
  EXPECT_TRUE(same_geometry(found.worst, readings[137].geometry, true, degrees(0.001)));
}

TEST(CrossValidation, ToldOfTheErrorBetweenReadingsWithinItsFactorOfFour) {
  const Direction i = direction_deg(30.0, 0.0);
  for (const int count : {190, 703}) {
    std::vector<TableReading> readings;
    add_spiral(readings, wheat(), i, count);
    const TabulatedSurface t = table(readings, {.symmetry = TableSymmetry::Turn});
    const CrossValidation found = cross_validate_views(t);
    const double told = found.rms / found.mean;
    const double real = interpolation_error(wheat(), t, i, 70.0).rms;
    EXPECT_GT(told, real) << count << " readings";
    EXPECT_LT(told, 8.0 * real) << count << " readings";
  }
}

TEST(CrossValidation, SeesThatAMovedLobeIsCloserThanAFadedOne) {
  const Surface truth = surface("glint", {{"slope_variance", 0.004}, {"refractive_index", 1.34}});
  std::vector<TableReading> readings;
  for (const double theta : {30.0, 40.0, 50.0}) {
    add_grid(readings, truth, direction_deg(theta, 0.0), {.theta_step = 2.0, .phi_step = 4.0, .last = 84.0});
  }
  const auto off = [&](Feature feature) {
    return cross_validate_incidences(table(readings, {.layout = TableLayout::Rings, .feature = feature})).rms;
  };
  EXPECT_LT(off(Feature::Lobe), 0.4 * off(Feature::Smooth));
}

TEST(CrossValidation, FindsASampleThatIsNotReciprocal) {
  std::vector<TableReading> readings;
  for (const double theta : {0.0, 15.0, 30.0, 45.0, 60.0}) {
    add_spiral(readings, wheat(), direction_deg(theta, 0.0), 300);
    for (std::size_t k = readings.size() - 300; k < readings.size(); ++k) {
      readings[k].f.value = readings[k].f.value * (1.0 + 0.2 * theta / 60.0);
    }
  }
  std::vector<TableReading> sound;
  for (const double theta : {0.0, 15.0, 30.0, 45.0, 60.0}) add_spiral(sound, wheat(), direction_deg(theta, 0.0), 300);
  const CrossValidation of_sound = compare_both_ways(table(sound));
  const CrossValidation of_bent = compare_both_ways(table(readings));
  EXPECT_LT(of_sound.rms / of_sound.mean, 0.01);
  EXPECT_GT(of_bent.rms / of_bent.mean, 0.05);
}

}  // namespace
}  // namespace gonio::reflectance
