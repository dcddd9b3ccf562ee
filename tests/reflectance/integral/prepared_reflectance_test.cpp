#include "reflectance/integral/prepared_reflectance.h"

#include <gtest/gtest.h>

#include <limits>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/surface/surface_sum.h"
#include "tests/reflectance/generated.h"
#include "tests/reflectance/printed.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

PreparedReflectance prepared(const Surface& s, double tolerance) {
  return PreparedReflectance::make(s, tolerance).value();
}

Direction at(double theta_deg) {
  return Direction::from_angles(degrees(theta_deg), 20.0_deg);
}

TEST(PreparedReflectance, ReadsTheReferenceValuesOfHapke) {
  const PreparedReflectance isotropic = prepared(surface("hapke", {{"omega0", 0.9}}), 1e-12);
  EXPECT_TRUE(agrees(isotropic.rho_dh(at(0)).value, "0.404754959067831", 1e-12));
  EXPECT_TRUE(agrees(isotropic.rho_dh(at(85)).value, "0.599393872596226", 1e-12));
}

TEST(PreparedReflectance, StatesAnErrorThatHoldsBetweenItsPoints) {
  constexpr std::uint64_t kSeed = 20261122;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  GeneratedDirections directions(kSeed);
  for (const Surface& s : {surface("hapke", {{"omega0", 0.999}}), surface("minnaert", {{"rho", 0.5}, {"k", 0.1}}),
                           surface("water_body", {{"rho_w", 0.3}, {"refractive_index", 1.34}})}) {
    for (const double tolerance : {1e-3, 1e-6, 1e-10}) {
      const PreparedReflectance rho = prepared(s, tolerance);
      for (int n = 0; n < 500; ++n) {
        const Direction i = directions.next();
        const Integral read = rho.rho_dh(i);
        const double truth = rho_dh(s, i).value;
        EXPECT_LE(std::abs(read.value - truth), read.error + 1e-15) << s.model() << " at mu " << i.mu();
        EXPECT_LE(read.error, tolerance * truth * 1.001) << s.model() << " at mu " << i.mu();
      }
    }
  }
}

TEST(PreparedReflectance, AddsTheMirrorPartExactly) {
  const Surface mirror = surface("fresnel_mirror", {{"refractive_index", 1.34}});
  const Surface body = surface("water_body", {{"rho_w", 1.0}, {"refractive_index", 1.34}});
  const PreparedReflectance rho = prepared(SurfaceSum::make({{mirror, 1.0}, {body, 1.0}}).value(), 1e-9);

  for (const double theta : {0.0, 53.0, 85.0}) EXPECT_NEAR(rho.rho_dh(at(theta)).value, 1.0, 1e-9) << theta;
  EXPECT_EQ(prepared(mirror, 1e-9).rho_dh(at(60)).value, mirror.specular(at(60)));
}

TEST(PreparedReflectance, FallsBackOnTheDirectIntegralAtTheHorizon) {
  const Surface s = surface("hapke_hg", {{"omega0", 0.9}, {"g", -0.3}});
  const Direction low = Direction::from_elevation(radians(1e-7), Angle{});

  const Integral rho = prepared(s, 1e-4).rho_dh(low);

  EXPECT_GT(rho.evaluations, 0u);
  EXPECT_EQ(rho.value, rho_dh(s, low, 1e-4).value);
}

TEST(PreparedReflectance, TakesMorePiecesForLessError) {
  const Surface s = surface("hapke", {{"omega0", 0.9}});

  EXPECT_LT(prepared(s, 1e-3).pieces(), prepared(s, 1e-12).pieces());
}

struct Brushed {
  [[nodiscard]] Brdf eval(const Direction&, const Direction&) const { return per_steradian(0.1); }
  [[nodiscard]] std::string_view model() const { return "brushed"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return false; }
};

TEST(PreparedReflectance, RefusesASurfaceThatKnowsAzimuthsAndATolerancePastItsReach) {
  const auto azimuths = PreparedReflectance::make(Brushed{});
  ASSERT_FALSE(azimuths.has_value());
  EXPECT_EQ(azimuths.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(azimuths.error().where->field, "surface");

  for (const double tolerance : {0.0, 1e-13, 0.1, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    const auto refused = PreparedReflectance::make(wheat(), tolerance);
    ASSERT_FALSE(refused.has_value()) << tolerance;
    EXPECT_EQ(refused.error().where->field, "relative_tolerance");
  }
}

}  // namespace
}  // namespace gonio::reflectance
