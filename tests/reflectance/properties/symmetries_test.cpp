// What every model keeps whatever its parameters, at generated geometries; each failure names surface and geometry.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reflectance/check/hard_pairs.h"
#include "reflectance/check/reciprocity_gap.h"
#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/table/tabulated_surface.h"
#include "tests/reflectance/properties/generated_surfaces.h"

namespace gonio::reflectance {
namespace {

constexpr std::uint64_t kSeed = 20260501;

TEST(EveryModel, IsReciprocalToTheLastBitWhateverItsParameters) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const std::vector<DirectionPair> pairs = hard_pairs(1000, kSeed);

  for (const Surface& s : GeneratedSurfaces(kSeed).of_every_model(20)) {
    const ReciprocityGap gap = worst_reciprocity_gap(s, pairs);

    EXPECT_EQ(gap.ulps, 0u) << text_of(s) << ", " << text_of(gap.pair.i, gap.pair.r) << ": " << gap.forth << " and "
                            << gap.back;
  }
}

TEST(TabulatedSurface, IsReciprocalToTheLastBitWhenAskedToBe) {
  std::vector<TableReading> readings;
  for (const double ti : {0.0, 30.0, 60.0}) {
    for (const double tr : {0.0, 20.0, 40.0, 60.0, 80.0}) {
      for (double phi = 0.0; phi < 360.0; phi += 30.0) {
        const Geometry g = geometry(ti, tr, phi);
        readings.push_back({.geometry = g, .f = {.value = wheat().eval(g), .u = per_steradian(1e-3)}});
      }
    }
  }
  const std::vector<DirectionPair> pairs = hard_pairs(1000, kSeed);

  for (const TableSymmetry symmetry : {TableSymmetry::Isotropic, TableSymmetry::Turn}) {
    TableOptions options{.symmetry = symmetry, .reciprocal = true};
    const ReciprocityGap gap = worst_reciprocity_gap(TabulatedSurface::make(readings, options).value(), pairs);
    EXPECT_EQ(gap.ulps, 0u) << text_of(gap.pair.i, gap.pair.r) << ": " << gap.forth << " and " << gap.back;

    options.reciprocal = false;
    EXPECT_GT(worst_reciprocity_gap(TabulatedSurface::make(readings, options).value(), pairs).ulps, 0u);
  }
}

TEST(EveryModel, IsFiniteAndNotNegativeWhateverItsParameters) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const std::vector<DirectionPair> pairs = hard_pairs(1000, kSeed + 1);

  for (const Surface& s : GeneratedSurfaces(kSeed + 1).of_every_model(20)) {
    for (const DirectionPair& p : pairs) {
      const double f = s.eval(p.i, p.r).si();
      const double share = s.specular(p.i);

      ASSERT_TRUE(std::isfinite(f) && f >= 0.0) << text_of(s) << ", " << text_of(p.i, p.r) << ": " << f;
      ASSERT_TRUE(share >= 0.0) << text_of(s) << ", " << text_of(p.i, p.r) << ": " << share;
    }
  }
}

// Azimuths that are multiples of 2^-20 rad add without rounding.
Angle exact_azimuth(GeneratedSurfaces& draw) {
  return radians(std::floor(0x1p20 * draw.unit()) * 0x1p-20);
}

TEST(EveryModel, IsUnchangedByAnyTurnAndByAMirrorImage) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  GeneratedSurfaces draw(kSeed + 2);
  for (const Surface& s : draw.of_every_model(10)) {
    ASSERT_TRUE(s.is_isotropic()) << text_of(s);
    for (int k = 0; k < 300; ++k) {
      const Angle theta_i = radians(0.5 * std::numbers::pi * draw.unit());
      const Angle theta_r = radians(0.5 * std::numbers::pi * draw.unit());
      const Angle phi_i = exact_azimuth(draw);
      const Angle phi_r = exact_azimuth(draw);
      const Angle turn = exact_azimuth(draw);
      const auto f = [&](Angle a, Angle b) {
        return s.eval(Direction::from_angles(theta_i, a), Direction::from_angles(theta_r, b));
      };
      SCOPED_TRACE(text_of(s) + ", " +
                   text_of(Direction::from_angles(theta_i, phi_i), Direction::from_angles(theta_r, phi_r)));

      ASSERT_EQ(f(phi_i, phi_r), f(phi_i + turn, phi_r + turn)) << turn.si();
      ASSERT_EQ(f(phi_i, phi_r), f(-phi_i, -phi_r));
    }
  }
}

TEST(EveryModel, ReflectsTheSameShareFromAllAzimuths) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  GeneratedSurfaces draw(kSeed + 3);
  for (const Surface& s : draw.of_every_model(2)) {
    const Angle theta = radians(1.4 * draw.unit());
    SCOPED_TRACE(text_of(s) + " at " + ::testing::PrintToString(theta.si()) + " rad");

    const Integral at_zero = rho_dh(s, Direction::from_angles(theta, {}), 1e-3);
    const Integral turned = rho_dh(s, Direction::from_angles(theta, radians(2.0)), 1e-3);

    EXPECT_NEAR(turned.value, at_zero.value, at_zero.error + turned.error);
  }
}

TEST(EveryModel, ReflectsAsMuchFromADirectionAsIntoIt) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  GeneratedSurfaces draw(kSeed + 4);
  for (const Surface& s : draw.of_every_model(2)) {
    const Direction d = Direction::from_angles(radians(1.4 * draw.unit()), radians(1.0));
    SCOPED_TRACE(text_of(s) + " at " + ::testing::PrintToString(d.theta().si()) + " rad");

    const Integral from = rho_dh(s, d, 1e-3);
    const Integral into = rho_hd(s, d, 1e-3);

    EXPECT_NEAR(into.value, from.value, from.error + into.error);
  }
}

}  // namespace
}  // namespace gonio::reflectance
