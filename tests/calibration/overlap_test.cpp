#include "calibration/overlap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "calibration/offset_overlap.h"
#include "calibration/profile_overlap.h"
#include "tests/calibration/scan_builder.h"

namespace gonio::calibration {
namespace {

constexpr double kPi = std::numbers::pi;

BeamDiscs discs(double spot_mm, double field_mm, std::optional<double> target_mm = std::nullopt) {
  BeamDiscs found{.spot_radius = millimetres(spot_mm), .field_radius = millimetres(field_mm), .target_radius = {}};
  if (target_mm) found.target_radius = millimetres(*target_mm);
  return found;
}

// Distance of a surface point from the axis of a beam: the length of the point's part across it.
double from_axis_mm(double x, double y, Angle theta, Angle phi) {
  const double nx = std::sin(theta.si()) * std::cos(phi.si());
  const double ny = std::sin(theta.si()) * std::sin(phi.si());
  const double along = x * nx + y * ny;
  return std::sqrt(std::max(0.0, x * x + y * y - along * along));
}

using Sums = std::array<double, 3>;

// The integrals over the plane of three things of both distances and the middle's, by a grid of midpoints.
Sums on_a_grid(const Geometry& g, double half_mm, double x0_mm,
               const std::function<Sums(double spot, double field, double middle)>& values) {
  constexpr int kCells = 800;
  const double step = 2.0 * half_mm / kCells;
  Sums sums{};
  for (int j = 0; j < kCells; ++j) {
    for (int k = 0; k < kCells; ++k) {
      const double x = -half_mm + (j + 0.5) * step;
      const double y = -half_mm + (k + 0.5) * step;
      const Sums here = values(from_axis_mm(x - x0_mm, y, g.theta_i, g.phi_i), from_axis_mm(x, y, g.theta_r, g.phi_r),
                               std::hypot(x, y));
      for (std::size_t n = 0; n < sums.size(); ++n) sums[n] += here[n] * step * step;
    }
  }
  return sums;
}

// A rim of some two thousand cells among a hundred thousand, each off by half a cell either way.
constexpr double kGridError = 1e-3;

double lens_mm2(double a, double b, double d) {
  const double first = a * a * std::acos((d * d + a * a - b * b) / (2.0 * d * a));
  const double second = b * b * std::acos((d * d + b * b - a * a) / (2.0 * d * b));
  return first + second - 0.5 * std::sqrt((-d + a + b) * (d + a - b) * (d - a + b) * (d + a + b));
}

const std::vector<Geometry> kDirections = {directions(0, 0, 0),    directions(0, 45, 0),    directions(60, 60, 90),
                                           directions(75, 30, 20), directions(20, 80, 135), directions(45, 45, 180)};

TEST(Overlap, WithTheFieldInsideTheSpotIsTheFieldOnTheSurface) {
  const Geometry g = directions(30, 60, 75);

  const Overlap found = overlap_of(discs(50, 5), g);

  EXPECT_NEAR(found.area_mm2 / (kPi * 25.0 / std::cos(g.theta_r.si())), 1.0, 1e-13);
  EXPECT_EQ(found.by_spot, 0.0);
  EXPECT_NEAR(found.by_field, 2.0, 1e-13);
  EXPECT_NEAR(found.field_mean_square, 0.5, 1e-13);
}

TEST(Overlap, WithTheSpotInsideTheFieldIsTheSpotOnTheSurface) {
  const Geometry g = directions(70, 20, 160);

  const Overlap found = overlap_of(discs(3, 40), g);

  EXPECT_NEAR(found.area_mm2 / (kPi * 9.0 / std::cos(g.theta_i.si())), 1.0, 1e-13);
  EXPECT_NEAR(found.by_spot, 2.0, 1e-13);
  EXPECT_NEAR(found.spot_mean_square, 0.5, 1e-13);
}

TEST(Overlap, OfEqualBeamsAtRightAnglesIsFourPQTimesTheirDiagonalsAnomaly) {
  // x^2/p^2 + y^2/q^2 <= 1 and the same turned by 90 deg cross on the diagonals: 4 p q atan(q / p).
  for (const double theta : {30.0, 60.0, 85.0, 89.0}) {
    const double mu = std::cos(theta * kPi / 180.0);

    const Overlap found = overlap_of(discs(4, 4), directions(theta, theta, 90));

    EXPECT_NEAR(found.area_mm2 / (4.0 * 16.0 / mu * std::atan(mu)), 1.0, 1e-11) << theta;
    EXPECT_NEAR(found.by_spot, 1.0, 1e-9) << theta;
  }
}

TEST(Overlap, OfOneConeAngleEndsAtTheEdgeOfTheTarget) {
  // The field alone beyond the edge: an ellipse and a circle, 4 times (sector of the circle + sector of the ellipse).
  const Geometry g = directions(0, 75, 0);
  const double p = 5.0 / std::cos(g.theta_r.si());
  const double q = 5.0;
  const double edge = 8.0;
  const double x = std::sqrt((edge * edge - q * q) / (1.0 - q * q / (p * p)));
  const double y = std::sqrt(edge * edge - x * x);
  const double expected = 2.0 * (edge * edge * std::atan2(y, x) + p * q * (kPi / 2.0 - std::atan2(y / q, x / p)));

  const Overlap found = overlap_of(discs(60, 5, edge), g);

  EXPECT_NEAR(found.area_mm2 / expected, 1.0, 1e-12);
  EXPECT_NEAR(found.by_field + found.by_target, 2.0, 1e-12);
  EXPECT_EQ(found.by_spot, 0.0);
}

TEST(Overlap, IsWhatAGridOfPointsCounts) {
  for (const Geometry& g : kDirections) {
    const Overlap found = overlap_of(discs(4.0, 4.5, 9.0), g);

    const auto [area, spot, field] = on_a_grid(g, 9.5, 0.0, [](double s, double f, double middle) {
      return s < 4.0 && f < 4.5 && middle < 9.0 ? Sums{1.0, s * s, f * f} : Sums{};
    });
    EXPECT_NEAR(found.area_mm2 / area, 1.0, kGridError);
    EXPECT_NEAR(found.spot_mean_square / (spot / area / 16.0), 1.0, 2.0 * kGridError);
    EXPECT_NEAR(found.field_mean_square / (field / area / 20.25), 1.0, 2.0 * kGridError);
  }
}

TEST(Overlap, ItsSensitivitiesAreItsSlopes) {
  constexpr double kStep = 1e-5;
  for (const Geometry& g : kDirections) {
    const auto logarithm = [&](double spot, double field, double target) {
      return std::log(overlap_of(discs(4.0 * spot, 4.3 * field, 9.0 * target), g).area_mm2);
    };

    const Overlap found = overlap_of(discs(4.0, 4.3, 9.0), g);

    EXPECT_NEAR(found.by_spot, (logarithm(1 + kStep, 1, 1) - logarithm(1 - kStep, 1, 1)) / (2 * kStep), 1e-8);
    EXPECT_NEAR(found.by_field, (logarithm(1, 1 + kStep, 1) - logarithm(1, 1 - kStep, 1)) / (2 * kStep), 1e-8);
    EXPECT_NEAR(found.by_target, (logarithm(1, 1, 1 + kStep) - logarithm(1, 1, 1 - kStep)) / (2 * kStep), 1e-8);
    EXPECT_NEAR(found.by_spot + found.by_field + found.by_target, 2.0, 1e-12);
  }
}

TEST(BeamMode, IsNotThatOfThePlaneOfIncidenceOutOfIt) {
  // Spot 8 mm, field 5 mm: in the plane 5 / cos 60 = 10 lies within 8 / cos 60 = 16; across it the spot is only 8 wide.
  EXPECT_EQ(beam_mode(discs(8, 5), directions(60, 60, 180)), BeamMode::Radiance);
  EXPECT_EQ(beam_mode(discs(8, 5), directions(60, 60, 90)), BeamMode::Mixed);

  const Geometry g = directions(60, 60, 90);
  const double by_the_rule = kPi * 25.0 / std::cos(g.theta_r.si());
  EXPECT_LT(overlap_of(discs(8, 5), g).area_mm2, 0.97 * by_the_rule) << "what the rule would be wrong by";
}

TEST(BeamMode, IsEitherLimitWithItsMargin) {
  EXPECT_EQ(beam_mode(discs(20, 5), directions(0, 75, 0)), BeamMode::Radiance);
  EXPECT_EQ(beam_mode(discs(19.5, 5), directions(0, 75, 0)), BeamMode::Mixed) << "5 / cos 75 = 19.3, within 2 %";
  EXPECT_EQ(beam_mode(discs(5, 20), directions(75, 0, 0)), BeamMode::Intensity);
  EXPECT_EQ(beam_mode(discs(20, 5, 18.0), directions(0, 75, 0)), BeamMode::Mixed) << "beyond the target's edge";
  EXPECT_EQ(beam_mode(discs(5, 5), directions(0, 0, 0)), BeamMode::Mixed) << "equal beams";
}

TEST(OffsetOverlap, InTheMiddleIsTheClosedForm) {
  for (const Geometry& g : kDirections) {
    for (const auto& beams : {discs(4.0, 4.5, 9.0), discs(4.0, 4.0), discs(3.0, 12.0)}) {
      const OffsetOverlap found = offset_overlap(beams, g, {});

      EXPECT_NEAR(found.area_mm2 / overlap_of(beams, g).area_mm2, 1.0, 1e-11);
    }
  }
}

TEST(OffsetOverlap, OfTwoCirclesIsTheLens) {
  for (const double d : {0.5, 1.0, 3.0, 6.5}) {
    const OffsetOverlap found =
        offset_overlap(discs(4.0, 3.0), {}, {.x = millimetres(0.6 * d), .y = millimetres(0.8 * d)});

    const double expected = d <= 1.0 ? kPi * 9.0 : lens_mm2(4.0, 3.0, d);
    EXPECT_NEAR(found.area_mm2 / expected, 1.0, 1e-12) << d;
  }
}

TEST(OffsetOverlap, OfBeamsApartIsNothing) {
  EXPECT_EQ(offset_overlap(discs(2.0, 2.0), directions(0, 60, 0), {.x = {}, .y = millimetres(4.5)}).area_mm2, 0.0);
}

TEST(OffsetOverlap, IsWhatAGridOfPointsCounts) {
  const Geometry g = directions(50, 65, 70);

  const OffsetOverlap found = offset_overlap(discs(4.0, 4.5, 8.0), g, {.x = millimetres(2.0), .y = {}});

  const double area = on_a_grid(g, 8.5, 2.0, [](double spot, double field, double middle) {
    return spot < 4.0 && field < 4.5 && middle < 8.0 ? Sums{1.0} : Sums{};
  })[0];
  EXPECT_NEAR(found.area_mm2 / area, 1.0, kGridError);
}

TEST(OffsetOverlap, ItsSensitivitiesAreItsSlopes) {
  constexpr double kStep_mm = 1e-4;
  for (const Geometry& g : kDirections) {
    const auto area = [&](double x, double y) {
      return offset_overlap(discs(4.0, 4.4, 7.0), g, {.x = millimetres(x), .y = millimetres(y)}).area_mm2;
    };

    const OffsetOverlap found = offset_overlap(discs(4.0, 4.4, 7.0), g, {.x = millimetres(1.2), .y = millimetres(0.7)});

    EXPECT_NEAR(found.per_x, (area(1.2 + kStep_mm, 0.7) - area(1.2 - kStep_mm, 0.7)) / (2 * kStep_mm), 1e-5);
    EXPECT_NEAR(found.per_y, (area(1.2, 0.7 + kStep_mm) - area(1.2, 0.7 - kStep_mm)) / (2 * kStep_mm), 1e-5);
  }
}

OverlapModel beams(double spot_mm, double field_mm) {
  OverlapModel model;
  model.spot_radius = {millimetres(spot_mm), {}};
  model.field_radius = {millimetres(field_mm), {}};
  return model;
}

TEST(ProfileOverlap, OfEvenProfilesIsTheClosedForm) {
  for (const Geometry& g : kDirections) {
    const double found = profile_overlap_mm2(beams(4.0, 4.5), millimetres(9.0), g);

    EXPECT_NEAR(found / overlap_of(discs(4.0, 4.5, 9.0), g).area_mm2, 1.0, 1e-9);
  }
}

TEST(ProfileOverlap, OfACircularConeIsAThirdOfItsCylinder) {
  OverlapModel model = beams(4.0, 50.0);
  model.spot_profile = {{0.0, 1.0}, {1.0, 0.0}};

  // On the surface its area grows as 1 / mu_i, its height stays.
  const double found = profile_overlap_mm2(model, std::nullopt, directions(60, 10, 40));

  EXPECT_NEAR(found / (kPi * 16.0 / 3.0 * 2.0), 1.0, 1e-9);
}

TEST(ProfileOverlap, OfTwoMeasuredProfilesIsWhatAGridAddsUp) {
  OverlapModel model = beams(3.0, 4.0);
  model.spot_profile = {{0.0, 1.0}, {0.5, 0.9}, {0.9, 0.7}, {1.2, 0.0}};
  model.field_profile = {{0.2, 1.0}, {0.8, 1.0}, {1.1, 0.0}};
  const auto linear = [](const std::vector<RadialNode>& nodes, double at) {
    if (at <= nodes.front().of_radius) return nodes.front().value;
    for (std::size_t k = 1; k < nodes.size(); ++k) {
      const RadialNode& a = nodes[k - 1];
      const RadialNode& b = nodes[k];
      if (at <= b.of_radius) return a.value + (b.value - a.value) * (at - a.of_radius) / (b.of_radius - a.of_radius);
    }
    return 0.0;
  };
  for (const Geometry& g : {directions(60, 60, 90), directions(20, 70, 30)}) {
    const double found = profile_overlap_mm2(model, millimetres(7.0), g);

    const double summed = on_a_grid(g, 7.5, 0.0, [&](double spot, double field, double middle) {
      return Sums{middle < 7.0 ? linear(model.spot_profile, spot / 3.0) * linear(model.field_profile, field / 4.0)
                               : 0.0};
    })[0];
    EXPECT_NEAR(found / summed, 1.0, 2e-4);
  }
}

}  // namespace
}  // namespace gonio::calibration
