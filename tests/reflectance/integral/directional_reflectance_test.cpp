#include "reflectance/integral/directional_reflectance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reflectance/integral/polar_integral.h"
#include "reflectance/surface/hapke.h"
#include "reflectance/surface/surface_sum.h"
#include "tests/reflectance/printed.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

struct Row {
  double theta_deg;
  Printed value;
};

void expect_rows(const Surface& s, double tolerance, std::initializer_list<Row> rows) {
  for (const Row& row : rows) {
    SCOPED_TRACE(::testing::Message() << s.model() << " at " << row.theta_deg << " deg");
    const Integral rho = rho_dh(s, degrees(row.theta_deg), tolerance);
    EXPECT_TRUE(agrees(rho.value, row.value, tolerance));
    EXPECT_LE(rho.error, tolerance * rho.value);
  }
}

TEST(RhoDh, IsClosedForLambertianAndMinnaert) {
  expect_rows(surface("lambertian", {{"rho", 0.37}}), 1e-14, {{0, "0.37"}, {89, "0.37"}});
  expect_rows(surface("minnaert", {{"rho", 0.5}, {"k", 0.5}}), 1e-14,
              {{0, "0.4"}, {30, "0.372241943640840"}, {60, "0.282842712474619"}, {85, "0.118088605883994"}});
  EXPECT_EQ(rho_dh(surface("lambertian", {{"rho", 0.37}}), 10.0_deg).evaluations, 0u);
}

TEST(RhoDh, IsClosedForHapkeAsPrinted) {
  expect_rows(
      surface("hapke_as_printed", {{"omega0", 0.5}}), 1e-14,
      {{0, "0.0551773860914967"}, {30, "0.0610631440365609"}, {60, "0.0862441167374843"}, {85, "0.166061224848999"}});
  expect_rows(
      surface("hapke_as_printed", {{"omega0", 0.9}}), 1e-14,
      {{0, "0.196227658216385"}, {30, "0.210798675227437"}, {60, "0.267124024982922"}, {85, "0.413612606644296"}});
  expect_rows(surface("hapke_as_printed", {{"omega0", 1.0}}), 1e-14,
              {{0, "0.5"}, {30, "0.508405611070704"}, {60, "0.544010195874729"}, {85, "0.658852111258086"}});
}

TEST(RhoDh, IsClosedForHapkesOwnForm) {
  expect_rows(
      surface("hapke", {{"omega0", 0.5}}), 1e-14,
      {{0, "0.113090702959704"}, {30, "0.122005031985154"}, {60, "0.156065215493783"}, {85, "0.238528640668947"}});
  expect_rows(
      surface("hapke", {{"omega0", 0.9}}), 1e-14,
      {{0, "0.404754959067831"}, {30, "0.423913459401245"}, {60, "0.486743912359091"}, {85, "0.599393872596226"}});
  // As a double, 0.999999 is 1e-10 off in 1 - omega0, which counts here.
  expect_rows(
      Hapke::make_from_co_albedo(1e-6).value(), 1e-14,
      {{0, "1.03622887174242"}, {30, "1.02765053180829"}, {60, "0.997669994808519"}, {85, "0.963961853917712"}});
  expect_rows(surface("hapke", {{"omega0", 1.0}}), 1e-14,
              {{0, "1.03972077083992"}, {30, "1.03083132278769"}, {60, "1"}, {85, "0.965330864519818"}});
}

TEST(RhoDh, IsClosedForChandrasekharsH) {
  expect_rows(
      surface("hapke_exact", {{"omega0", 0.9}}), 1e-14,
      {{0, "0.414947479130817"}, {30, "0.436123541359631"}, {60, "0.507938906940098"}, {85, "0.634860024266183"}});
  expect_rows(
      surface("hapke_exact", {{"omega0", 0.5}}), 1e-14,
      {{0, "0.115225877707205"}, {30, "0.124479360165716"}, {60, "0.160144433435235"}, {85, "0.246339119211403"}});
  expect_rows(surface("hapke_exact", {{"omega0", 1.0}}), 1e-14, {{0, "1"}, {85, "1"}});
}

// f of another surface and nothing else of it, so that only quadrature is left.
struct FormulaHidden {
  Surface surface;
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const { return surface.eval(i, r); }
  [[nodiscard]] std::string_view model() const { return "hidden"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return surface.is_isotropic(); }
};

TEST(RhoDh, IsTheSameByFormulaAsByQuadrature) {
  for (const char* model : {"hapke", "hapke_as_printed", "hapke_exact"}) {
    const Surface closed = surface(model, {{"omega0", 0.9}});
    const Integral rings = rho_dh(FormulaHidden{closed}, 40.0_deg, 1e-11);
    EXPECT_GT(rings.evaluations, 0u);
    EXPECT_NEAR(rings.value, rho_dh(closed, 40.0_deg).value, 1e-11) << model;
  }
  const Surface body = surface("water_body", {{"rho_w", 0.3}, {"refractive_index", 1.34}});
  EXPECT_NEAR(rho_dh(FormulaHidden{body}, 40.0_deg, 1e-9).value, rho_dh(body, 40.0_deg).value, 1e-9);
}

TEST(RhoDh, DoesNotDependOnTheMethodForAPhaseFunction) {
  // g on either side of where the method changes from rings to polar coordinates.
  const auto at = [](double g) {
    return rho_dh(surface("hapke_hg", {{"omega0", 0.9}, {"g", g}}), 50.0_deg, 1e-11).value;
  };
  EXPECT_NEAR(at(-0.5), at(std::nextafter(-0.5, -1.0)), 1e-11);
}

TEST(RhoDh, CountsTheMirrorPart) {
  const Surface mirror = surface("fresnel_mirror", {{"refractive_index", 1.34}});
  const Surface body = surface("water_body", {{"rho_w", 1.0}, {"refractive_index", 1.34}});
  const Surface both = SurfaceSum::make({{mirror, 1.0}, {body, 1.0}}).value();

  EXPECT_TRUE(agrees(rho_dh(mirror, 60.0_deg).value, "0.0610048547310245", 1e-14));
  // What a loss-free body does not send up is mirrored: everything comes back, at every angle.
  for (const double theta : {0.0, 30.0, 60.0, 89.0, 89.99}) {
    EXPECT_NEAR(rho_dh(both, degrees(theta)).value, 1.0, 1e-14) << theta;
  }
}

TEST(RhoDh, MatchesTheReferenceForWheat) {
  expect_rows(wheat(), 1e-12, {{0, "0.742575513854292"}, {30, "0.734215727909711"}, {60, "0.712386680567085"}});
  expect_rows(
      wheat(), 1e-10,
      {{80, "0.713447834768679"}, {85, "0.747348019118055"}, {89, "0.903431333882796"}, {89.9, "1.25859711892973"}});
}

TEST(RhoDh, MatchesTheReferenceForWheatAsAReflectanceFactor) {
  expect_rows(surface("rpv_brf", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}}), 1e-12,
              {{0, "0.236369127297830"}, {30, "0.233708124785289"}, {60, "0.226759723210157"}});
}

TEST(RhoDh, MatchesTheReferenceForASeaWithoutShadowing) {
  expect_rows(sea(), 1e-12,
              {{0, "0.0211735434107334"},
               {30, "0.0232881722959141"},
               {60, "0.0620081099133315"},
               {75, "0.151030730145936"},
               {85, "0.376287594971279"},
               {89, "1.47"}});
}

TEST(RhoDh, MatchesTheReferenceForASeaWithSmithShadowing) {
  expect_rows(sea("cox_munk_smith"), 1e-12,
              {{0, "0.0211735035186920"},
               {30, "0.0232564147586820"},
               {60, "0.0585238108747566"},
               {75, "0.133536030301337"},
               {85, "0.252164369204699"},
               {89, "0.333593199"}});
}

// By mpmath's adaptive quadrature of the formula in vectors (Walter et al. 2007), 15 digits.
TEST(RhoDh, MatchesTheReferenceForFacetsWithALongTail) {
  expect_rows(surface("ggx", {{"roughness", 0.3}, {"refractive_index", 1.5}}), 1e-9,
              {{0, "0.0355973437"}, {30, "0.0376080325"}, {60, "0.0609831982"}});
}

TEST(RhoDh, OfFacetsThatHideEachOtherIsNeverAboveOne) {
  for (const double roughness : {0.05, 0.3, 1.0}) {
    const Surface mirror = surface("ggx", {{"roughness", roughness}, {"refractive_index", 1e12}});
    for (const double theta : {0.0, 30.0, 60.0, 85.0}) {
      EXPECT_LE(rho_dh(mirror, degrees(theta), 1e-6).value, 1.0) << roughness << " at " << theta;
    }
  }
  // With alpha = 1 the normal's facets are spread evenly, and f = 1 / (2 pi (1 + mu_r)).
  const Surface rough = surface("ggx", {{"roughness", 1.0}, {"refractive_index", 1e12}});
  EXPECT_NEAR(rho_dh(rough, 0.0_deg).value, 1.0 - std::numbers::ln2, 1e-9);
}

TEST(RhoDh, IsNeverClippedWhereAModelBreaksEnergy) {
  // Facets that mirror all: more comes out than goes in unless they hide each other.
  const auto furnace = [](std::string_view model, Angle theta) {
    return rho_dh(surface(model, {{"slope_variance", 0.0542}, {"refractive_index", 1e12}}), theta).value;
  };

  EXPECT_TRUE(agrees(furnace("glint", 80.0_deg), "1.0232", 0.0));
  EXPECT_TRUE(agrees(furnace("glint", 85.0_deg), "1.3279", 0.0));
  for (const double theta : {0.0, 30.0, 60.0, 75.0, 80.0, 85.0}) EXPECT_LE(furnace("glint_smith", degrees(theta)), 1.0);
  EXPECT_GT(rho_dh(wheat(), 89.5162_deg).value, 1.0);
  EXPECT_LT(rho_dh(wheat(), 89.5161_deg).value, 1.0);
}

TEST(RhoDh, FindsALobeNarrowerThanAnyGridWouldMeet) {
  // A mirror with slopes of a milliradian still sends everything back.
  for (const double variance : {1e-3, 1e-4, 1e-6}) {
    const Surface polished = surface("glint", {{"slope_variance", variance}, {"refractive_index", 1e12}});
    const Integral rho = rho_dh(polished, 30.0_deg, 1e-9);
    EXPECT_NEAR(rho.value, 1.0, 1e-9) << variance;
    EXPECT_LE(rho.error, 1e-9) << variance;
  }
}

TEST(RhoDh, OfASumIsTheSumOfWhatEachTermGivesByItsOwnMethod) {
  const Surface sum = SurfaceSum::make({{wheat(), 0.25}, {sea(), 0.5}}).value();

  const Integral rho = rho_dh(sum, 30.0_deg, 1e-12);

  EXPECT_NEAR(rho.value, 0.25 * 0.734215727909711 + 0.5 * 0.0232881722959141, 1e-13);
}

TEST(RhoDh, StatesAnErrorThatHoldsAtEveryTolerance) {
  const double truth = 0.712386680567085;
  std::uint64_t evaluations = 0;
  for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-9, 1e-12}) {
    const Integral rho = rho_dh(wheat(), 60.0_deg, tolerance);
    EXPECT_LE(std::abs(rho.value - truth), rho.error + 1e-15) << tolerance;
    EXPECT_LE(rho.error, tolerance) << tolerance;
    EXPECT_GE(rho.evaluations, evaluations);
    evaluations = rho.evaluations;
  }
}

TEST(RhoDh, StatesAnErrorThatHoldsWhereverTheDifficultyLies) {
  const Surface surfaces[] = {surface("glint", {{"slope_variance", 1e-4}, {"refractive_index", 1.34}}),
                              sea("cox_munk_smith"), surface("hapke_hg", {{"omega0", 0.9}, {"g", -0.49}}),
                              surface("hapke_hg", {{"omega0", 0.9}, {"g", 0.9}}),
                              surface("rpv", {{"rho0", 0.133}, {"k", 0.5}, {"g", -0.9}})};
  for (const Surface& s : surfaces) {
    for (const double theta : {0.0, 60.0, 88.0, 89.9}) {
      const Integral close = rho_dh(s, degrees(theta), 1e-10);
      for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
        const Integral rho = rho_dh(s, degrees(theta), tolerance);
        EXPECT_LE(std::abs(rho.value - close.value), rho.error + close.error)
            << s.model() << " at " << theta << " deg to " << tolerance;
      }
    }
  }
}

TEST(RhoDh, DoesNotDependOnTheAzimuthOfAnIsotropicSurface) {
  const double at_zero = rho_dh(wheat(), 60.0_deg, 1e-12).value;
  const double turned = rho_dh(wheat(), Direction::from_angles(60.0_deg, 123.0_deg), 1e-12).value;

  EXPECT_NEAR(turned, at_zero, 1e-13);
  // A smooth surface in grazing light is integrated about its normal, which has no azimuth of its own.
  const Surface forward = surface("hapke_hg", {{"omega0", 0.9}, {"g", 0.4}});
  for (const Angle theta : {40.0_deg, 89.0_deg}) {
    EXPECT_NEAR(rho_dh(forward, Direction::from_angles(theta, 123.0_deg), 1e-10).value,
                rho_dh(forward, theta, 1e-10).value, 1e-10);
  }
}

TEST(RhoDh, TakesFewEvaluationsWhereNothingIsSharp) {
  EXPECT_LE(rho_dh(wheat(), 30.0_deg, 1e-6).evaluations, 600u);
  EXPECT_LE(rho_dh(sea(), 30.0_deg, 1e-6).evaluations, 2400u);
}

TEST(RhoDh, IsTheSameByTheExactAsByTheFastPath) {
  // FormulaHidden has no kernel.
  const double exact = rho_dh(FormulaHidden{wheat()}, 50.0_deg, 1e-6).value;
  EXPECT_NEAR(rho_dh(wheat(), 50.0_deg, 1e-12).value, exact, 1e-6);
  EXPECT_NEAR(polar_integral(FormulaHidden{wheat()}, Direction::from_angles(50.0_deg, {}),
                             Direction::from_angles(50.0_deg, {}), 1e-12)
                  .value,
              rho_dh(wheat(), 50.0_deg, 1e-12).value, 1e-14);
}

TEST(RhoDh, StatesAnErrorThatHoldsWhereTheLadderIsTempted) {
  // Lobes on either side of what evenly spread nodes can meet.
  for (const double variance : {1e-3, 0.01, 0.03, 0.15, 1.0}) {
    for (const double theta : {0.0, 45.0, 70.0, 74.0, 80.0}) {
      const Surface s = surface("glint_smith", {{"slope_variance", variance}, {"refractive_index", 1.34}});
      const Integral close = rho_dh(s, degrees(theta), 1e-9);
      for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
        const Integral rho = rho_dh(s, degrees(theta), tolerance);
        EXPECT_LE(std::abs(rho.value - close.value), rho.error + close.error) << variance << " at " << theta;
      }
    }
  }
}

// f = a + b sin(phi_r) sin(theta_r) + c cos(2 phi_i): neither a turn nor a mirror image leaves it as it is.
struct OneSided {
  Feature where = Feature::Smooth;
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    return per_steradian(0.1 + 0.02 * r.vector().y + 0.05 * std::cos(2.0 * i.phi().si()) * r.mu());
  }
  [[nodiscard]] std::string_view model() const { return "one-sided"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return false; }
  [[nodiscard]] Feature feature() const { return where; }
};

TEST(RhoDh, GoesAllAroundForAnAnisotropicSurfaceByEveryMethod) {
  // 0.1 pi + 0 + 0.05 cos(2 phi_i) 2 pi/3.
  const double expected = 0.1 * std::numbers::pi + 0.05 * 0.5 * 2.0 * std::numbers::pi / 3.0;
  for (const Feature feature : {Feature::Smooth, Feature::HotSpot, Feature::Lobe}) {
    const Surface s = OneSided{feature};
    const Integral rho = rho_dh(s, Direction::from_angles(50.0_deg, 30.0_deg), 1e-12);
    EXPECT_NEAR(rho.value, expected, 1e-13);
  }
}

}  // namespace
}  // namespace gonio::reflectance
