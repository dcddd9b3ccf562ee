// Where the short form of an angle fails and ours must hold. Each test shows both, so that nobody puts the short form
// back; its name is the case's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "base/geometry.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kSeed = 20260401;

Direction at(double theta, double phi = 0.0) {
  return Direction::from_angles(radians(theta), radians(phi));
}

double relative_error(double computed, double truth) {
  return std::abs(computed / truth - 1.0);
}

double unit(std::mt19937_64& engine) {
  return static_cast<double>(engine() >> 11U) * 0x1p-53;
}

double naive_retro_distance(double ti, double tr, double dphi) {
  const double a = std::tan(ti);
  const double b = std::tan(tr);
  return std::sqrt(a * a + b * b - 2.0 * a * b * std::cos(dphi));
}

struct WorstErrors {
  double naive = 0.0;  ///< 1 at least where it is NaN
  double least_naive = 1.0;
  double ours = 0.0;
  void add(double naive_error, double our_error) {
    const double counted = std::isnan(naive_error) ? 1.0 : naive_error;
    naive = std::max(naive, counted);
    least_naive = std::min(least_naive, counted);
    ours = std::max(ours, our_error);
  }
};

// In the plane G = |tan tr - tan ti| = sin(tr - ti) / (cos ti cos tr), and the difference of close doubles is exact.
WorstErrors retro_errors_in_the_plane(double offset) {
  std::mt19937_64 engine(kSeed);
  WorstErrors worst;
  for (int k = 0; k < 500; ++k) {
    const double ti = 0.2 + 1.2 * unit(engine);
    const double tr = ti + offset;
    const double truth = std::sin(tr - ti) / (std::cos(ti) * std::cos(tr));
    worst.add(relative_error(naive_retro_distance(ti, tr, 0.0), truth),
              relative_error(retro_distance(at(ti), at(tr)), truth));
  }
  return worst;
}

WorstErrors retro_errors_in_azimuth(double offset) {
  std::mt19937_64 engine(kSeed);
  WorstErrors worst;
  for (int k = 0; k < 500; ++k) {
    const double theta = 0.2 + 1.2 * unit(engine);
    const double truth = 2.0 * std::tan(theta) * std::sin(0.5 * offset);
    worst.add(relative_error(naive_retro_distance(theta, theta, offset), truth),
              relative_error(retro_distance(at(theta), at(theta, offset)), truth));
  }
  return worst;
}

TEST(HardCase, GNearRetro) {
  // offset, and what the textbook form loses there at its worst and at its best
  const struct {
    double offset;
    double naive_worst;
    double naive_best;
  } rows[] = {{1e-6, 1e-5, 0.0}, {1e-8, 3e-2, 0.0}, {1e-10, 1.0, 0.99}, {1e-12, 1.0, 0.99}};
  for (const auto& row : rows) {
    for (const WorstErrors& errors : {retro_errors_in_the_plane(row.offset), retro_errors_in_azimuth(row.offset)}) {
      EXPECT_LT(errors.ours, 2e-15) << row.offset;  // the truth's own functions count for half of it
      EXPECT_GE(errors.naive, row.naive_worst) << row.offset;
      EXPECT_GE(errors.least_naive, row.naive_best) << row.offset;
    }
  }
}

TEST(HardCase, GNearRetroHasNoNegativeRadicand) {
  std::mt19937_64 engine(kSeed);
  constexpr int kDraws = 10000;
  int naive_failures = 0;
  for (int k = 0; k < kDraws; ++k) {
    const double ti = 1.5 * unit(engine);
    const double tr = ti * (1.0 + 1e-9 * unit(engine));
    const double dphi = 1e-9 * unit(engine);
    naive_failures += std::isnan(naive_retro_distance(ti, tr, dphi)) ? 1 : 0;
    ASSERT_GE(retro_distance(at(ti), at(tr, dphi)), 0.0);
  }
  EXPECT_GT(naive_failures, kDraws / 20);
}

TEST(HardCase, GNearRetroAndTheHorizon) {
  // Elevations 2e-12 and 3e-12 rad: tangents 5e11 and 3.3e11, whose difference is the truth.
  const Direction i = Direction::from_elevation(radians(2e-12), {});
  const Direction r = Direction::from_elevation(radians(3e-12), {});
  const double truth = 1.0 / 2e-12 - 1.0 / 3e-12;

  EXPECT_LT(relative_error(retro_distance(i, r), truth), 1e-15);
  EXPECT_GT(relative_error(naive_retro_distance(i.theta().si(), r.theta().si(), 0.0), truth), 1e-6);
}

TEST(HardCase, XiNear0) {
  const struct {
    double offset;
    double naive;
  } rows[] = {{1e-6, 1e-5}, {1e-8, 0.4}, {1e-10, 1.0}, {1e-12, 1.0}};
  for (const auto& row : rows) {
    WorstErrors worst;
    std::mt19937_64 engine(kSeed);
    for (int k = 0; k < 500; ++k) {
      const double ti = 0.2 + 1.2 * unit(engine);
      const double tr = ti + row.offset;
      const double cosine = std::cos(ti) * std::cos(tr) + std::sin(ti) * std::sin(tr);
      worst.add(relative_error(std::acos(cosine), tr - ti), relative_error(phase_angle(at(ti), at(tr)).si(), tr - ti));
    }
    EXPECT_LT(worst.ours, 1e-15) << row.offset;
    EXPECT_GE(worst.naive, row.naive) << row.offset;
  }
}

TEST(HardCase, XiNear180) {
  // Both close to the horizon, opposite: what is missing to 180 deg is the sum of the elevations.
  const Direction i = Direction::from_elevation(radians(1e-10), {});
  const Direction r = Direction::from_elevation(radians(2e-10), radians(kPi));

  // As a double, pi is 1e-16 short: that counts for 1e-13 here.
  EXPECT_LT(relative_error(std::sqrt(cos2_half_phase(i, r)), std::sin(1.5e-10)), 1e-12);
  EXPECT_LT(relative_error(kPi - phase_angle(i, r).si(), 3e-10), 1e-5);
  EXPECT_EQ(std::acos(-1.0 + 0.5 * 9e-20), kPi);  // the cosine has nothing left of it
}

TEST(HardCase, ThetaTo90) {
  const double elevation = degrees(1e-10).si();
  const Direction i = Direction::from_elevation(radians(elevation), {});
  const Surface minnaert = surface("minnaert", {{"rho", 0.5}, {"k", 0.5}});

  EXPECT_LT(relative_error(i.mu(), std::sin(elevation)), 1e-15);
  EXPECT_LT(relative_error(minnaert.eval(i, i).si(), 0.5 / kPi * std::sin(elevation)), 1e-15);
  // By way of theta = 90 - 1e-10 deg the cosine has four digits left, and so has everything that is made of it.
  EXPECT_GT(relative_error(std::cos(degrees(90.0 - 1e-10).si()), std::sin(elevation)), 1e-6);
}

TEST(HardCase, ThetaAt90) {
  const Direction horizon = Direction::from_angles(degrees(90.0), {});
  const Direction aside = Direction::from_angles(degrees(90.0), degrees(1.0));
  // What the tangents, the powers and 1/mu would be made of: a cosine of 6e-17, or, a rounding further, below 0.
  EXPECT_GT(naive_retro_distance(horizon.theta().si(), aside.theta().si(), degrees(1.0).si()), 1e14);
  EXPECT_TRUE(std::isnan(std::pow(std::cos(std::nextafter(degrees(90.0).si(), 2.0)), 0.851 - 1.0)));

  for (const Surface& s : {wheat(), sea(), sea("cox_munk_smith"), surface("hapke", {{"omega0", 0.9}})}) {
    SCOPED_TRACE(s.model());
    for (const Direction& r : {horizon, aside, mirrored(horizon), Direction()}) {
      EXPECT_TRUE(std::isfinite(s.eval(horizon, r).si()));
      EXPECT_EQ(s.eval(horizon, r), s.eval(r, horizon));
    }
  }
  EXPECT_FALSE(Direction::make(degrees(90.0 + 1e-9), {}).has_value());
}

TEST(HardCase, Theta0Pole) {
  // phi is undefined there: one direction, whatever azimuth it came with, and no -0.
  const Direction pole = Direction::from_angles({}, {});
  for (const double phi_deg : {10.0, 200.0, -90.0, 360.0}) {
    EXPECT_EQ(Direction::from_angles({}, degrees(phi_deg)), pole);
  }
  EXPECT_EQ(Direction::from_vector({.x = 0.0, .y = -0.0, .z = 3.0}), pole);
  EXPECT_EQ(mirrored(pole), pole);
  // A stored phi compared as a number says that they differ.
  const Geometry a = geometry(30, 0, 0);
  const Geometry b = geometry(30, 0, 200);
  EXPECT_NE(a, b);
  EXPECT_TRUE(same_geometry(a, b, false, radians(1e-9)));
  EXPECT_EQ(wheat().eval(a), wheat().eval(b));
}

TEST(HardCase, SineNearTheta0) {
  const struct {
    double tilt;
    double naive_error;
  } rows[] = {{1e-4, 1e-10}, {1e-6, 1e-6}, {1e-8, 1.0}, {1e-12, 1.0}};
  for (const auto& row : rows) {
    const Direction d = Direction::from_vector({.x = row.tilt, .y = 0.0, .z = 1.0});
    const double truth = std::sin(std::atan(row.tilt));

    EXPECT_LT(relative_error(d.sin_theta(), truth), 1e-15);
    EXPECT_GE(relative_error(std::sqrt(1.0 - d.mu() * d.mu()), truth), row.naive_error) << row.tilt;
  }
}

TEST(HardCase, PhiWrap) {
  const Direction i = Direction::from_angles(degrees(30.0), degrees(359.9));
  const Direction r = Direction::from_angles(degrees(30.0), degrees(0.1));

  // 0.2 deg apart, not 359.8: the average of the two azimuths as numbers would be their opposite.
  EXPECT_NEAR(in_degrees(azimuth_difference(i, r)), 0.2, 1e-12);
  EXPECT_NEAR(in_degrees(azimuth_difference(r, i)), -0.2, 1e-12);
  EXPECT_LT(relative_error(retro_distance(i, r), 2.0 * std::tan(kPi / 6.0) * std::sin(degrees(0.1).si())), 1e-12);
  EXPECT_EQ(0.5 * (359.9 + 0.1), 180.0);
}

}  // namespace
}  // namespace gonio::reflectance
