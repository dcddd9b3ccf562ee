// No surface sends back more light than it gets, but for those formulas that are known to: they have to be flagged by a
// value above 1, never clipped.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/surface/fresnel.h"
#include "reflectance/surface/hapke.h"
#include "tests/reflectance/properties/generated_surfaces.h"

namespace gonio::reflectance {
namespace {

constexpr std::uint64_t kSeed = 20260515;

Direction generated_incidence(GeneratedSurfaces& draw) {
  const double theta = 0.5 * 3.14159 * draw.unit();
  return Direction::from_angles(radians(theta), radians(0.3));
}

// Whose physics forbids it, for all parameters. Not among them: Minnaert and RPV, which are fits; Hapke's H, which is
// an approximation; a single order of anisotropic scattering; facets that do not hide each other.
const std::set<std::string_view> kConserving{"lambertian", "hapke_as_printed", "hapke_exact",   "fresnel_mirror",
                                             "water_body", "glint_smith",      "cox_munk_smith"};

TEST(Energy, IsKeptByEveryModelWhosePhysicsSaysSo) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  GeneratedSurfaces draw(kSeed);
  std::size_t models = 0;
  for (const ModelSpec& spec : surface_models()) {
    if (!kConserving.contains(spec.name)) continue;
    ++models;
    for (int k = 0; k < 12; ++k) {
      const Surface s = draw.next(spec);
      const Direction i = generated_incidence(draw);

      const Integral rho = rho_dh(s, i, 1e-4);

      EXPECT_LE(rho.value, 1.0 + rho.error) << text_of(s) << " at theta_i " << i.theta().si() << " rad";
      EXPECT_GE(rho.value, 0.0) << text_of(s) << " at theta_i " << i.theta().si() << " rad";
    }
  }
  EXPECT_EQ(models, kConserving.size());
}

TEST(Energy, IsFlaggedAboveOneWhereMinnaertsFormulaIs) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  GeneratedSurfaces draw(kSeed);
  int above = 0;
  for (int k = 0; k < 500; ++k) {
    const double rho = 2.0 * draw.unit();
    const double exponent = -0.9 + 3.0 * draw.unit();
    const Direction i = generated_incidence(draw);
    const double formula = 2.0 * rho * std::pow(i.mu(), exponent) / (exponent + 2.0);

    const double value = rho_dh(surface("minnaert", {{"rho", rho}, {"k", exponent}}), i).value;

    EXPECT_NEAR(value, formula, 1e-14 * formula) << rho << " " << exponent << " " << i.theta().si();
    above += value > 1.0 ? 1 : 0;
  }
  EXPECT_GT(above, 50);
}

TEST(Energy, IsBrokenByHapkesHOnlyWithAlmostNoLossAndFlagged) {
  // rho_dh(0) = 1 at omega0 = 0.9998641404.
  const Direction normal;
  for (const double omega0 : {0.0, 0.5, 0.99, 0.999864}) {
    EXPECT_LE(rho_dh(surface("hapke", {{"omega0", omega0}}), normal).value, 1.0) << omega0;
  }
  for (const double omega0 : {0.9998642, 0.99999, 1.0}) {
    EXPECT_GT(rho_dh(surface("hapke", {{"omega0", omega0}}), normal).value, 1.0) << omega0;
  }
}

TEST(Energy, IsBrokenByWheatTowardsTheHorizonAndFlagged) {
  EXPECT_LT(rho_dh(wheat(), degrees(89.51), 1e-6).value, 1.0);
  EXPECT_GT(rho_dh(wheat(), degrees(89.52), 1e-6).value, 1.0);
}

TEST(Energy, IsBrokenByFacetsThatDoNotHideEachOtherAndFlagged) {
  const Surface open = surface("glint", {{"slope_variance", 0.0542}, {"refractive_index", 1e12}});
  const Surface hiding = surface("glint_smith", {{"slope_variance", 0.0542}, {"refractive_index", 1e12}});

  // A white furnace: every facet mirrors all.
  EXPECT_GT(rho_dh(open, degrees(85), 1e-4).value, 1.3);
  EXPECT_LE(rho_dh(hiding, degrees(85), 1e-4).value, 1.0);
  EXPECT_GT(rho_dh(sea("cox_munk"), degrees(89), 1e-4).value, 1.0);
  EXPECT_LT(rho_dh(sea("cox_munk_smith"), degrees(89), 1e-4).value, 0.4);
}

TEST(Energy, OfAMirrorOverLossFreeWaterIsAllThereAtEveryAngleAndIndex) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  GeneratedSurfaces draw(kSeed);
  for (int k = 0; k < 100; ++k) {
    const double n = 1.0 + 3.0 * draw.unit();
    const Surface sea_without_waves =
        SurfaceSum::make({{surface("fresnel_mirror", {{"refractive_index", n}}), 1.0},
                          {surface("water_body", {{"rho_w", 1.0}, {"refractive_index", n}}), 1.0}})
            .value();
    const Direction i = generated_incidence(draw);

    EXPECT_NEAR(rho_dh(sea_without_waves, i).value, 1.0, 1e-14) << n << " at theta_i " << i.theta().si() << " rad";
  }
}

}  // namespace
}  // namespace gonio::reflectance
