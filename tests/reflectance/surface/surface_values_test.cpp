// Values of the models at points, against references computed with 25 to 40 digits from the printed formulas.
#include <gtest/gtest.h>

#include <cmath>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/surface/hapke.h"
#include "tests/reflectance/printed.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

struct Point {
  double theta_i;
  double theta_r;
  double phi_r;
  Printed f;
};

// How much a relative change of the angles is magnified in f, by differences: the nearest double to 89.9 deg alone
// moves f.
double condition(const Surface& s, const Point& p) {
  const double f = s.eval(geometry(p.theta_i, p.theta_r, p.phi_r)).si();
  const auto slope = [&](double di, double dr, double dphi) {
    const Geometry moved = geometry(p.theta_i * (1 - di), p.theta_r * (1 - dr), p.phi_r * (1 - dphi));
    return std::abs(s.eval(moved).si() / f - 1.0);
  };
  constexpr double kStep = 1e-6;
  return 1.0 + (slope(kStep, 0, 0) + slope(0, kStep, 0) + slope(0, 0, kStep)) / kStep;
}

void expect_points(const Surface& s, std::initializer_list<Point> points) {
  for (const Point& p : points) {
    SCOPED_TRACE(::testing::Message() << s.model() << " (" << p.theta_i << ", " << p.theta_r << ", " << p.phi_r << ")");
    const double allowed = std::max(1e-14, 4.0 * condition(s, p) * 0x1p-53);
    EXPECT_TRUE(agrees(s.eval(geometry(p.theta_i, p.theta_r, p.phi_r)).si(), p.f, allowed));
  }
}

TEST(Lambertian, IsRhoByPiEverywhere) {
  expect_points(surface("lambertian", {{"rho", 0.5}}),
                {{0, 0, 0, "0.159154943091895336"}, {60, 90, 33, "0.159154943091895336"}});
}

TEST(Minnaert, MatchesTheReference) {
  const Surface s = surface("minnaert", {{"rho", 0.5}, {"k", 0.5}});

  // RADF = pi f at normal incidence.
  EXPECT_TRUE(agrees(std::numbers::pi * s.eval(geometry(0, 45, 0)).si(), "0.420448207626857", 1e-14));
  // Both cosines count, wherever the azimuth: rho/pi (cos 30 cos 60)^0.5.
  expect_points(s, {{30, 60, 123, "0.104729842318088131"}, {60, 30, -7, "0.104729842318088131"}});
}

// By vectors as Walter et al. (2007) write it, Fresnel's formula in Cook and Torrance's form, 20 digits.
TEST(Facets, MatchTheReferenceInBothDistributions) {
  expect_points(surface("ggx", {{"roughness", 0.3}, {"refractive_index", 1.5}}), {{0, 0, 0, "0.0353677651315323"},
                                                                                  {30, 0, 0, "0.014437834839131"},
                                                                                  {30, 30, 180, "0.0482339203822854"},
                                                                                  {30, 60, 180, "0.0340494948697298"},
                                                                                  {30, 30, 0, "0.00373357862695259"},
                                                                                  {60, 60, 180, "0.279901943889786"},
                                                                                  {85, 85, 180, "19.9701021717627"}});
  expect_points(surface("beckmann", {{"roughness", 0.3}, {"refractive_index", 1.5}}),
                {{0, 0, 0, "0.0353677651315323"},
                 {30, 0, 0, "0.0211701048437998"},
                 {30, 30, 180, "0.0489520827719106"},
                 {30, 60, 180, "0.0530527995240711"},
                 {30, 30, 0, "0.00206502705794488"},
                 {60, 60, 180, "0.315204756887822"},
                 {85, 85, 180, "34.0177474473846"}});
}

TEST(Hapke, MatchesTheReferenceInBothForms) {
  expect_points(
      surface("hapke_as_printed", {{"omega0", 0.9}}),
      {{30, 0, 0, "0.0566928341897537"}, {30, 30, 0, "0.0601064249033492"}, {30, 60, 0, "0.0720374813270021"}});
  expect_points(surface("hapke", {{"omega0", 0.9}}),
                {{30, 0, 0, "0.124506105155933"}, {30, 30, 0, "0.128843744102195"}, {30, 60, 0, "0.140626923681759"}});
}

TEST(Hapke, MatchesTheReferenceWithHenyeyAndGreensteinsPhaseFunction) {
  expect_points(
      surface("hapke_hg", {{"omega0", 0.9}, {"g", -0.3}}),
      {{30, 0, 0, "0.167203507657713"}, {30, 30, 180, "0.141082721635402"}, {30, 60, 180, "0.130122882500356"}});
}

TEST(Hapke, MatchesTheReferenceWithChandrasekharsH) {
  // With the H of 30 digits.
  expect_points(surface("hapke_exact", {{"omega0", 0.9}}), {{30, 0, 0, "0.126617551814542238"},
                                                            {30, 30, 180, "0.131474020864090284"},
                                                            {30, 60, 180, "0.145471145962881675"}});
  expect_points(surface("hapke_exact_hg", {{"omega0", 0.9}, {"g", -0.3}}), {{30, 0, 0, "0.169314954316322411"},
                                                                            {30, 30, 180, "0.143712998397297998"},
                                                                            {30, 60, 180, "0.134967104781478389"}});
}

TEST(Hapke, IsTheIsotropicOneWithoutAsymmetry) {
  const Surface hg = surface("hapke_hg", {{"omega0", 0.9}, {"g", 0.0}});
  EXPECT_EQ(hg.model(), "hapke");
  EXPECT_EQ(hg.eval(geometry(30, 60, 10)), surface("hapke", {{"omega0", 0.9}}).eval(geometry(30, 60, 10)));
}

TEST(Hapke, RefusesAnAsymmetryWithTheFormAsPrinted) {
  const Result<Hapke> refused = Hapke::make({.omega0 = 0.9, .form = HapkeForm::AsPrinted, .g = -0.3});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(refused.error().where->field, "g");
}

TEST(Hapke, KnowsNoAzimuth) {
  const Surface s = surface("hapke", {{"omega0", 0.9}});
  EXPECT_EQ(s.eval(geometry(30, 60, 0)), s.eval(geometry(30, 60, 137)));
}

TEST(Rpv, MatchesTheReferenceForWheat) {
  expect_points(wheat(), {{0, 0, 0, "0.317804642149467"},
                          {30, 0, 0, "0.257144598137328"},
                          {30, 30, 0, "0.338909735285344"},
                          {30, 30, 180, "0.207715427930345"},
                          {30, 60, 0, "0.270298377717503"},
                          {30, 60, 180, "0.175707298205257"},
                          {60, 60, 0, "0.433232116784638"},
                          {60, 60, 180, "0.161093055617504"},
                          {85, 85, 0, "0.945905870716091"},
                          {89.9, 89.9, 0, "5.43301809989142"}});
}

TEST(Rpv, IsPiTimesLessWhereEq8IsAReflectanceFactor) {
  const Surface brf = surface("rpv_brf", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}});

  for (const Geometry& g : {geometry(0, 0, 0), geometry(30, 60, 45), geometry(70, 20, 180)}) {
    EXPECT_DOUBLE_EQ(std::numbers::pi * brf.eval(g).si(), wheat().eval(g).si());
  }
}

TEST(Rpv, IsHenyeyAndGreensteinsFunctionWhereTheRestIsOne) {
  // rho0 = k = 1 leaves F alone; at xi = 0 and, from horizon to horizon, at 180 deg.
  const Surface s = surface("rpv", {{"rho0", 1.0}, {"k", 1.0}, {"g", -0.114}});
  expect_points(s, {{40, 40, 0, "1.41911551141661868"}, {90, 90, 180, "0.713942671853897998"}});
}

TEST(Glint, MatchesTheReferenceForASea) {
  expect_points(sea(), {{0, 0, 0, "0.0309968076783968"},
                        {30, 0, 0, "0.0109615417943348"},
                        {30, 30, 180, "0.0434563925506677"},
                        {30, 45, 180, "0.0435880112239037"},
                        {30, 60, 180, "0.0298089148059663"},
                        {30, 30, 0, "1.567456169042552e-4"},
                        {60, 60, 180, "0.358273955093931"},
                        {85, 85, 180, "113.135468698274"}});
}

TEST(Glint, PeaksBeyondTheMirrorDirection) {
  // In the plane of incidence at 30 deg: 0.0457490578 at 37.55 deg (Mobley 2005, footnote 6).
  const Surface s = sea();
  const double peak = s.eval(geometry(30, 37.55, 180)).si();

  EXPECT_TRUE(agrees(peak, "0.0457490578", 1e-9));
  EXPECT_GT(peak, s.eval(geometry(30, 37.45, 180)).si());
  EXPECT_GT(peak, s.eval(geometry(30, 37.65, 180)).si());
}

TEST(Glint, LosesWhatFacetsHideOnlyTowardsTheHorizon) {
  const Geometry steep = geometry(10, 20, 30);
  const Geometry grazing = geometry(85, 85, 180);

  EXPECT_EQ(sea("cox_munk_smith").eval(steep), sea().eval(steep));
  // Lambda(85 deg) = (exp(-v^2)/(v sqrt(pi)) - erfc(v))/2 = 0.354243059105155 with v = cot(85 deg)/sqrt(0.0542).
  EXPECT_NEAR(sea("cox_munk_smith").eval(grazing) / sea().eval(grazing), 1.0 / (1.0 + 2.0 * 0.354243059105155), 1e-14);
}

TEST(Glint, TakesItsSlopeVarianceFromTheWind) {
  const Surface by_variance = surface("glint", {{"slope_variance", 0.0542}, {"refractive_index", 1.34}});
  EXPECT_EQ(by_variance.eval(geometry(30, 40, 170)), sea().eval(geometry(30, 40, 170)));
}

TEST(WaterBody, MatchesTheReference) {
  expect_points(surface("water_body", {{"rho_w", 0.02}, {"refractive_index", 1.34}}),
                {{30, 45, 77, "0.00339964174142800"}});
}

TEST(FresnelMirror, NeverHidesInEval) {
  const Surface mirror = surface("fresnel_mirror", {{"refractive_index", 1.34}});
  const Direction i = Direction::from_angles(degrees(60), degrees(10));

  EXPECT_EQ(mirror.eval(i, mirrored(i)), Brdf());
  EXPECT_TRUE(agrees(mirror.specular(i), "0.0610048547310245", 1e-14));
}

TEST(FresnelMirror, ReflectsAllFromTheDenserSideBeyondTheCriticalAngle) {
  const Surface from_below = surface("fresnel_mirror", {{"refractive_index", 1.0 / 1.34}});
  EXPECT_EQ(from_below.specular(Direction::from_angles(radians(std::asin(1.0 / 1.34)), {})), 1.0);
  EXPECT_LT(from_below.specular(Direction::from_angles(degrees(48.268), {})), 1.0);
}

}  // namespace
}  // namespace gonio::reflectance
