#include "reflectance/light/energy_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reflectance/light/lit_reflectance.h"
#include "reflectance/surface/hapke.h"
#include "tests/reflectance/light/lights.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

TEST(EnergyReport, FindsWhereWheatGivesBackTooMuch) {
  const EnergyReport report = energy_report(wheat(), 1e-9_deg);

  ASSERT_EQ(report.excesses.size(), 1U);
  EXPECT_NEAR(in_degrees(report.excesses[0].from_theta_i), 89.5161915585, 2e-9);  // by an independent oracle
  EXPECT_EQ(in_degrees(report.excesses[0].to_theta_i), 90.0);
  EXPECT_GT(report.excesses[0].worst.value, 1.2586);
}

TEST(EnergyReport, FindsTheLossBelowWhichHapkesHGivesBackTooMuch) {
  // omega0 = .9998641404 at normal incidence.
  const EnergyReport below = energy_report(surface("hapke", {{"omega0", 0.99986414035}}));
  const EnergyReport above = energy_report(surface("hapke", {{"omega0", 0.99986414045}}));

  EXPECT_TRUE(below.keeps_energy());
  ASSERT_EQ(above.excesses.size(), 1U);
  EXPECT_EQ(in_degrees(above.excesses[0].from_theta_i), 0.0);
  EXPECT_LT(in_degrees(above.excesses[0].to_theta_i), 1.0);
}

TEST(EnergyReport, FindsAnExcessThatEndsAboveTheHorizon) {
  // Without loss rho_dh is exactly 1 at 60 deg and falls.
  const EnergyReport report = energy_report(surface("hapke", {{"omega0", 1.0}}));

  ASSERT_EQ(report.excesses.size(), 1U);
  EXPECT_NEAR(in_degrees(report.excesses[0].to_theta_i), 60.0, 1e-9);
  EXPECT_NEAR(report.excesses[0].worst.value, 1.03972077083992, 1e-13);
  EXPECT_EQ(in_degrees(report.excesses[0].worst_theta_i), 0.0);
}

TEST(EnergyReport, FindsThatGlintWithoutShadowingGivesBackTooMuch) {
  const EnergyReport report = energy_report(sea(), 1e-3_deg);

  ASSERT_EQ(report.excesses.size(), 1U);
  EXPECT_GT(in_degrees(report.excesses[0].from_theta_i), 85.0);
  EXPECT_LT(in_degrees(report.excesses[0].from_theta_i), 89.0);  // 1.47 there
}

TEST(EnergyReport, IsEmptyForSurfacesThatKeepEnergy) {
  for (const Surface& s :
       {surface("lambertian", {{"rho", 1.0}}), surface("hapke_exact", {{"omega0", 1.0}}),
        surface("fresnel_mirror", {{"refractive_index", 1.34}}), surface("hapke_hg", {{"omega0", 0.9}, {"g", -0.3}})}) {
    EXPECT_TRUE(energy_report(s).keeps_energy()) << s.model();
  }
}

// rho_dh = 1.1 sin^2(theta_i) cos^2(phi_i): too much towards phi_i = 0 and 180 deg only, from 72.45 deg.
struct Banded {
  [[nodiscard]] Brdf eval(const Direction& i, const Direction&) const {
    const double x = i.sin_theta() * std::cos(i.phi().si());
    return per_steradian(1.1 * x * x / std::numbers::pi);
  }
  [[nodiscard]] std::string_view model() const { return "banded"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return false; }
};

TEST(EnergyReport, LooksAllAroundAnAnisotropicSurface) {
  const EnergyReport report = energy_report(Banded{});

  ASSERT_EQ(report.excesses.size(), 2U);
  EXPECT_EQ(in_degrees(report.excesses[0].phi_i), 0.0);
  EXPECT_NEAR(in_degrees(report.excesses[1].phi_i), 180.0, 1e-12);
  EXPECT_NEAR(std::sin(report.excesses[1].from_theta_i.si()), std::sqrt(1.0 / 1.1), 1e-9);
}

// f < 0 in some directions, as Hapke's phase function form with a = 1 can be.
struct Negative {
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    return per_steradian(0.1 - 0.3 * i.mu() * r.sin_theta());
  }
  [[nodiscard]] std::string_view model() const { return "negative"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return true; }
};

struct Broken {
  [[nodiscard]] Brdf eval(const Direction&, const Direction& r) const { return per_steradian(1.0 / (r.mu() - r.mu())); }
  [[nodiscard]] std::string_view model() const { return "broken"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return true; }
};

TEST(LitIntegral, FlagsReflectancesAboveOne) {
  const Light setting = Beam::make(Direction::from_angles(89.6_deg, 0_deg), 1.0).value();
  const Light high = Beam::make(Direction::from_angles(30_deg, 0_deg), 1.0).value();

  EXPECT_TRUE(hemispherical_reflectance(wheat(), setting)->is_above_one);
  EXPECT_FALSE(hemispherical_reflectance(wheat(), setting)->is_physical());
  EXPECT_FALSE(hemispherical_reflectance(wheat(), high)->is_above_one);
}

TEST(LitIntegral, FlagsNegativeBrdfs) {
  const Light overcast = OvercastSky::make(1.0).value();
  const Direction low = Direction::from_angles(80_deg, 0_deg);

  EXPECT_TRUE(hemispherical_reflectance(Negative{}, overcast)->has_negative_brdf);
  EXPECT_TRUE(reflected_radiance(Negative{}, overcast, low)->has_negative_brdf);
  EXPECT_FALSE(reflected_radiance(Negative{}, overcast, Direction())->has_negative_brdf);
  EXPECT_FALSE(hemispherical_reflectance(wheat(), overcast, 1e-3)->has_negative_brdf);
}

TEST(LitIntegral, RefusesABrdfThatIsNotFinite) {
  const Result<LitIntegral> r = hemispherical_reflectance(Broken{}, UniformSky::make(1.0).value());

  ASSERT_FALSE(r);
  EXPECT_NE(describe(r.error()).find("broken"), std::string::npos);
}

}  // namespace
}  // namespace gonio::reflectance
