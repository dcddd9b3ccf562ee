// The reflectances that integrate over all incidences: A (rho_hh) and rho_hd.
#include <gtest/gtest.h>

#include <cmath>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/surface/surface_sum.h"
#include "tests/reflectance/printed.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

void expect_albedo(const Surface& s, Printed expected, double tolerance = 1e-12) {
  const Integral albedo = bond_albedo(s, tolerance);
  EXPECT_TRUE(agrees(albedo.value, expected, tolerance)) << s.model();
  EXPECT_LE(albedo.error, 2.0 * tolerance * albedo.value) << s.model();
}

TEST(BondAlbedo, MatchesTheReferenceForHapke) {
  expect_albedo(surface("hapke_as_printed", {{"omega0", 0.5}}), "0.0775948628486422");
  expect_albedo(surface("hapke_as_printed", {{"omega0", 0.9}}), "0.246088287962694");
  expect_albedo(surface("hapke_as_printed", {{"omega0", 1.0}}), "0.531827418517348");
  expect_albedo(surface("hapke", {{"omega0", 0.5}}), "0.143051823092017");
  expect_albedo(surface("hapke", {{"omega0", 0.9}}), "0.460458651382695");
  expect_albedo(surface("hapke", {{"omega0", 0.999999}}), "1.01088672897247");
  expect_albedo(surface("hapke", {{"omega0", 1.0}}), "1.01360403518928");
}

TEST(BondAlbedo, MatchesTheReferenceForTheExactH) {
  // 1 - 2 gamma integral of H mu dmu, with 20 digits.
  expect_albedo(surface("hapke_exact", {{"omega0", 0.5}}), "0.1465443806997184");
  expect_albedo(surface("hapke_exact", {{"omega0", 0.9}}), "0.4780244892282389");
  expect_albedo(surface("hapke_exact", {{"omega0", 1.0}}), "1");
}

TEST(BondAlbedo, MatchesTheReferenceForWheat) {
  expect_albedo(wheat(), "0.72465595303254", 1e-10);
  expect_albedo(surface("rpv_brf", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}}), "0.23066515393220", 1e-10);
}

TEST(BondAlbedo, IsClosedForMinnaertAndForFlatInterfaces) {
  expect_albedo(surface("minnaert", {{"rho", 0.5}, {"k", 0.5}}), "0.32", 1e-14);
  expect_albedo(surface("lambertian", {{"rho", 0.37}}), "0.37", 1e-14);
  expect_albedo(surface("fresnel_mirror", {{"refractive_index", 1.34}}), "0.067510612213279929", 1e-14);
  expect_albedo(surface("fresnel_mirror", {{"refractive_index", 1.0 / 1.34}}), "0.480680893413499626", 1e-14);
}

TEST(BondAlbedo, OfASumIsTheSumOfItsTerms) {
  // A mirror over a loss-free body returns everything.
  const Surface mirror = surface("fresnel_mirror", {{"refractive_index", 1.34}});
  const Surface body = surface("water_body", {{"rho_w", 1.0}, {"refractive_index", 1.34}});
  expect_albedo(SurfaceSum::make({{mirror, 1.0}, {body, 1.0}}).value(), "1", 1e-14);
}

// As Lambertian, with nothing in closed form, brighter for light from phi = 0.
struct Striped {
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    return per_steradian(0.1 + 0.05 * std::cos(2.0 * i.phi().si()) + 0.04 * r.mu());
  }
  [[nodiscard]] std::string_view model() const { return "striped"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return false; }
};

TEST(BondAlbedo, GoesAllAroundForAnAnisotropicSurface) {
  // 0.1 pi + 0 + 0.04 * 2 pi/3.
  EXPECT_NEAR(bond_albedo(Striped{}, 1e-10).value, 0.1 * std::numbers::pi + 0.04 * 2.0 * std::numbers::pi / 3.0, 1e-11);
}

TEST(RhoHd, IsRhoDhOfAReciprocalSurface) {
  EXPECT_TRUE(
      agrees(rho_hd(wheat(), Direction::from_angles(60.0_deg, 33.0_deg), 1e-12).value, "0.712386680567085", 1e-12));
  EXPECT_TRUE(
      agrees(rho_hd(surface("minnaert", {{"rho", 0.5}, {"k", 0.5}}), Direction::from_angles(60.0_deg, {}), 1e-9).value,
             "0.282842712474619", 1e-9));
  const Surface mirror = surface("fresnel_mirror", {{"refractive_index", 1.34}});
  EXPECT_TRUE(agrees(rho_hd(mirror, Direction::from_angles(60.0_deg, {})).value, "0.0610048547310245", 1e-14));
}

TEST(RhoHd, TellsTheDirectionsOfANonReciprocalSurfaceApart) {
  const Direction d = Direction::from_angles(60.0_deg, 0.0_deg);

  // Light from everywhere, seen at mu = 1/2: 0.1 pi + 0.04 pi/2; light from phi = 0, seen everywhere: 0.15 pi + 0.04 *
  // 2 pi/3.
  EXPECT_NEAR(rho_hd(Striped{}, d, 1e-12).value, 0.12 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(rho_dh(Striped{}, d, 1e-12).value, 0.15 * std::numbers::pi + 0.04 * 2.0 * std::numbers::pi / 3.0, 1e-12);
}

}  // namespace
}  // namespace gonio::reflectance
