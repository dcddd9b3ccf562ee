#include <gtest/gtest.h>

#include <numbers>
#include <set>
#include <string_view>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/light/quantity_name.h"
#include "reflectance/light/reflectance_factor.h"
#include "tests/reflectance/printed.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

const Direction kFrom = Direction::from_angles(30_deg, 0_deg);
const Direction kTo = Direction::from_angles(60_deg, 180_deg);

TEST(ReflectanceFactor, ScalesTheBrdfByPiAndCosines) {
  constexpr double kBrdf = 0.175707298205257;  // wheat (30, 60, 180)

  EXPECT_NEAR(reff(wheat(), kFrom, kTo), std::numbers::pi * kBrdf, 1e-14);
  EXPECT_NEAR(i_over_f(wheat(), kFrom, kTo), std::numbers::pi * kBrdf * 0.866025403784438647, 1e-14);
  EXPECT_NEAR(in_per_steradian(radiance_reflectance(wheat(), kFrom, kTo)), kBrdf * 0.866025403784438647, 1e-14);
}

TEST(ReflectanceFactor, OfNormalIncidenceMatchesTheReference) {
  const Surface minnaert = surface("minnaert", {{"rho", 0.5}, {"k", 0.5}});

  EXPECT_TRUE(
      agrees(radf_normal_incidence(minnaert, Direction::from_angles(45_deg, 0_deg)), "0.420448207626857", 1e-14));
}

TEST(ReflectanceFactor, TowardsTheSourceIsTheNormalAlbedo) {
  EXPECT_TRUE(agrees(normal_albedo(wheat(), kFrom) / std::numbers::pi, "0.338909735285344", 1e-14));
}

TEST(QuantityName, IsFoundWithUnitFormulaAndSource) {
  const Result<QuantityName> q = find_quantity("i_over_f");

  ASSERT_TRUE(q);
  EXPECT_EQ(q->symbol, "I/F");
  EXPECT_EQ(q->unit, "1");
  EXPECT_EQ(q->formula, "pi f mu_i");
  EXPECT_FALSE(q->source.empty());
}

TEST(QuantityName, ThatIsNotSupportedSaysWhy) {
  for (const char* name : {"radf", "albedo", "physical_albedo", "geometric_albedo", "single_scattering_albedo"}) {
    const Result<QuantityName> q = find_quantity(name);
    ASSERT_FALSE(q) << name;
    EXPECT_EQ(q.error().code, ErrorCode::InvalidInput);
    EXPECT_EQ(q.error().seen, "a name that is not supported");
    EXPECT_GT(q.error().limit.size(), 20U) << name;
  }
}

TEST(QuantityName, ThatDoesNotExistIsAnsweredWithThoseThatDo) {
  const Result<QuantityName> q = find_quantity("rho_xy");

  ASSERT_FALSE(q);
  EXPECT_NE(q.error().limit.find("rho_dh"), std::string::npos);
  EXPECT_EQ(q.error().limit.find("physical_albedo"), std::string::npos);
}

TEST(QuantityName, IsUnique) {
  std::set<std::string_view> seen;
  for (const QuantityName& q : quantity_names()) EXPECT_TRUE(seen.insert(q.name).second) << q.name;
}

}  // namespace
}  // namespace gonio::reflectance
