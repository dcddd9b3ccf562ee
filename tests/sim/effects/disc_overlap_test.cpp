#include "sim/optics/disc_overlap.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tests/sim/effects/effects_bench.h"

namespace gonio::sim::test {
namespace {

constexpr double kPi = std::numbers::pi;

double common(const std::vector<SurfaceEllipse>& ellipses) {
  return common_area_mm2(ellipses);
}

bool holds(const SurfaceEllipse& e, double x, double y) {
  const double c = std::cos(e.azimuth.si()), s = std::sin(e.azimuth.si());
  const double u = c * (x - e.centre_x_mm) + s * (y - e.centre_y_mm);
  const double v = c * (y - e.centre_y_mm) - s * (x - e.centre_x_mm);
  return std::pow(u / e.long_mm, 2) + std::pow(v / e.short_mm, 2) < 1.0;
}

// Counted on a grid of 2000 x 2000 points over the first ellipse's square.
double counted(const std::vector<SurfaceEllipse>& ellipses) {
  const double half = ellipses[0].long_mm;
  constexpr int kSide = 2000;
  const double step = 2.0 * half / kSide;
  long inside = 0;
  for (int a = 0; a < kSide; ++a) {
    for (int b = 0; b < kSide; ++b) {
      const double x = ellipses[0].centre_x_mm - half + (a + 0.5) * step;
      const double y = ellipses[0].centre_y_mm - half + (b + 0.5) * step;
      bool all = true;
      for (const SurfaceEllipse& e : ellipses) all = all && holds(e, x, y);
      inside += all ? 1 : 0;
    }
  }
  return static_cast<double>(inside) * step * step;
}

TEST(DiscOverlap, OfADiscInsideAnotherIsTheSmallerOne) {
  const SurfaceEllipse small{.centre_x_mm = 1.0, .long_mm = 2.0, .short_mm = 2.0};
  const SurfaceEllipse large{.long_mm = 5.0, .short_mm = 4.0, .azimuth = degrees(30.0)};

  EXPECT_NEAR(common({small, large}), 4.0 * kPi, 1e-11);
  EXPECT_NEAR(common({large, small}), 4.0 * kPi, 1e-11);
  EXPECT_NEAR(common({small}), 4.0 * kPi, 1e-12);
}

TEST(DiscOverlap, OfEqualDiscsIsTheirAreaHoweverTheyAreTurned) {
  const SurfaceEllipse ellipse{.long_mm = 3.0, .short_mm = 2.0, .azimuth = degrees(20.0)};
  SurfaceEllipse turned = ellipse;
  turned.azimuth = degrees(200.0);

  EXPECT_NEAR(common({ellipse, turned}), 6.0 * kPi, 1e-9);
  EXPECT_NEAR(common({ellipse, turned, ellipse}), 6.0 * kPi, 1e-9);
}

TEST(DiscOverlap, OfTwoCirclesIsTheLens) {
  const double r = 3.0, big = 4.0, d = 5.0;
  const SurfaceEllipse one{.long_mm = r, .short_mm = r};
  const SurfaceEllipse two{.centre_x_mm = 3.0, .centre_y_mm = 4.0, .long_mm = big, .short_mm = big};

  // Circular segments of both (any table of plane geometry).
  const double lens = r * r * std::acos((d * d + r * r - big * big) / (2 * d * r)) +
                      big * big * std::acos((d * d + big * big - r * r) / (2 * d * big)) -
                      0.5 * std::sqrt((-d + r + big) * (d + r - big) * (d - r + big) * (d + r + big));
  EXPECT_NEAR(common({one, two}), lens, 1e-11);
}

TEST(DiscOverlap, OfCrossedEllipsesIsTheClosedForm) {
  const SurfaceEllipse one{.long_mm = 3.0, .short_mm = 1.0};
  const SurfaceEllipse two{.long_mm = 3.0, .short_mm = 1.0, .azimuth = degrees(90.0)};

  EXPECT_NEAR(common({one, two}), 4.0 * 3.0 * 1.0 * std::atan(1.0 / 3.0), 1e-11);
}

TEST(DiscOverlap, OfDiscsApartIsNothing) {
  const SurfaceEllipse one{.long_mm = 1.0, .short_mm = 1.0};
  const SurfaceEllipse two{.centre_x_mm = 5.0, .long_mm = 2.0, .short_mm = 1.0};

  EXPECT_EQ(common({one, two}), 0.0);
}

TEST(DiscOverlap, OfThreeIsWhatAGridCounts) {
  const std::vector<SurfaceEllipse> three{
      {.centre_x_mm = 0.4, .centre_y_mm = -0.2, .long_mm = 6.0, .short_mm = 2.0, .azimuth = degrees(25.0)},
      {.centre_x_mm = -0.3, .centre_y_mm = 0.5, .long_mm = 5.0, .short_mm = 3.0, .azimuth = degrees(100.0)},
      {.centre_x_mm = 1.0, .centre_y_mm = 0.0, .long_mm = 2.5, .short_mm = 2.5}};

  // The grid errs by some rim points in 4e6.
  EXPECT_NEAR(common(three) / counted(three), 1.0, 3e-4);
}

Scene filled(double spot_mm, double field_mm) {
  Scene scene = quiet_scene();
  scene.effects.overlap = OverlapSpec{.spot_radius = millimetres(spot_mm), .field_radius = millimetres(field_mm)};
  return scene;
}

const std::array kGeometries{at_deg(0, 0, 0), at_deg(0, 60, 0), at_deg(60, 0, 0), at_deg(45, 60, 90)};

TEST(OverlapInALightPath, ChangesNothingWhereTheFieldLiesInsideTheSpot) {
  for (const Geometry& g : kGeometries)
    EXPECT_NEAR(target_rate(filled(50.0, 5.0), g) / target_rate(quiet_scene(), g), 1.0, 1e-11);
}

TEST(OverlapInALightPath, GivesTheOtherCosineWhereTheSpotLiesInsideTheField) {
  // Intensity mode: q = K'' f mu_r, with K'' lower by the areas of the two discs.
  for (const Geometry& g : kGeometries) {
    const double expected = kWhite * 0.5 * std::cos(g.theta_r.si()) * std::pow(5.0 / 50.0, 2);
    EXPECT_NEAR(target_rate(filled(5.0, 50.0), g) / expected, 1.0, 1e-11);
  }
}

TEST(OverlapInALightPath, IsMixedBetweenAndTakesTheTrueArea) {
  // 60/60/90: either ellipse is long where the other is short, so an in-plane rule of thumb errs.
  const Geometry g = at_deg(60, 60, 90);
  const SurfaceEllipse spot{.long_mm = 12.0, .short_mm = 6.0};
  const SurfaceEllipse field{.long_mm = 10.0, .short_mm = 5.0, .azimuth = degrees(90.0)};

  const double factor = target_rate(filled(6.0, 5.0), g) / target_rate(quiet_scene(), g);

  EXPECT_NEAR(factor / (counted({spot, field}) * 0.5 / (kPi * 25.0)), 1.0, 3e-4);
  EXPECT_LT(factor, 0.9);
}

TEST(OverlapInALightPath, LosesTheLightThatRunsOffTheSample) {
  Scene scene = filled(10.0, 5.0);
  scene.effects.overlap->sample_radius = millimetres(8.0);

  const double on_sample = target_rate(scene, at_deg(0, 75, 0)) / target_rate(quiet_scene(), at_deg(0, 75, 0));
  const double on_reference =
      target_rate(scene, at_deg(0, 40, 0), kReferenceMm) / target_rate(quiet_scene(), at_deg(0, 40, 0), kReferenceMm);

  const SurfaceEllipse field{.long_mm = 5.0 / std::cos(in_rad(75.0)), .short_mm = 5.0};
  const SurfaceEllipse edge{.long_mm = 8.0, .short_mm = 8.0};
  EXPECT_NEAR(on_sample / (counted({edge, field}) * std::cos(in_rad(75.0)) / (kPi * 25.0)), 1.0, 3e-4);
  EXPECT_NEAR(on_reference, 1.0, 1e-11) << "an endless reference";
}

}  // namespace
}  // namespace gonio::sim::test
