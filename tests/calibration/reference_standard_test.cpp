#include "calibration/reference_standard.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/calibration/reference_text.h"

namespace gonio::calibration {
namespace {

using namespace gonio::literals;

constexpr double kPi = std::numbers::pi;
constexpr double kSixDigits = 2e-6;  // the texts carry six decimals

ReferenceStandard standard(const ReferenceText& text) {
  auto parsed = ReferenceStandard::parse(text.text(), "white.toml");
  EXPECT_TRUE(parsed) << describe(parsed.error());
  return std::move(parsed).value();
}

Error refusal(const ReferenceText& text) {
  const auto parsed = ReferenceStandard::parse(text.text(), "white.toml");
  EXPECT_FALSE(parsed) << "it was taken";
  return parsed ? Error{} : parsed.error();
}

std::string without(std::string text, const std::string& line) {
  const auto at = text.find(line);
  EXPECT_NE(at, std::string::npos);
  return text.erase(at, text.find('\n', at) - at + 1);
}

Geometry at(Angle theta_i, Angle theta_r, Angle phi_r) {
  return {.theta_i = theta_i, .phi_i = {}, .theta_r = theta_r, .phi_r = phi_r};
}

TEST(ReferenceStandard, GivesAFlatTableTheShapeOneWhateverItsScale) {
  const ReferenceStandard white = standard({.shape = [](double, double, double) { return 3.7; }});

  EXPECT_NEAR(white.shape(at(8.0_deg, 20.0_deg, 33.0_deg), 568.0_nm), 1.0, 1e-14);
  EXPECT_NEAR(white.shape(at(60.0_deg, 60.0_deg, 180.0_deg), 568.0_nm), 1.0, 1e-14);
}

// s = 1 + a theta_r integrates to 2 int (1 + a t) sin t cos t dt = 1 + a (T/2 + sin(2T)/4), held constant beyond T.
TEST(ReferenceStandard, NormalisesByTheHemisphereAtEightDegreesAsTheClosedFormSays) {
  const double a = 0.25;
  for (const double last_deg : {90.0, 75.0}) {
    const double last = last_deg * kPi / 180.0;
    ReferenceText text{.theta_deg = {0, 20, 45, last_deg},
                       .shape = [&](double, double r, double) { return 1.0 + a * r * kPi / 180.0; }};

    const ReferenceStandard white = standard(text);

    const double mean = 1.0 + a * (last / 2.0 + std::sin(2.0 * last) / 4.0);
    EXPECT_NEAR(white.shape(at(40.0_deg, 45.0_deg, 70.0_deg), 568.0_nm), (1.0 + a * kPi / 4.0) / mean, kSixDigits);
  }
}

TEST(ReferenceStandard, ScalesTheWholeTableByOneFactorAndNotEachIncidence) {
  ReferenceText text{.shape = [](double i, double, double) { return 1.0 + i / 90.0; }};

  const ReferenceStandard white = standard(text);

  // At theta_i = 8 deg the table says 1 + 8/90 whatever the view: that is the certificate's geometry.
  EXPECT_NEAR(white.shape(at(8.0_deg, 10.0_deg, 0.0_deg), 568.0_nm), 1.0, kSixDigits);
  EXPECT_NEAR(white.shape(at(60.0_deg, 10.0_deg, 0.0_deg), 568.0_nm), (1.0 + 60.0 / 90.0) / (1.0 + 8.0 / 90.0),
              kSixDigits);
}

TEST(ReferenceStandard, ExchangesTheDirectionsForACertificateWithHemisphericalLight) {
  const double a = 0.25;
  ReferenceText text{.shape = [&](double i, double, double) { return 1.0 + a * i * kPi / 180.0; }};
  const auto geometry = text.certificate.find("8/h");
  text.certificate.replace(geometry, 3, "h/8");

  const ReferenceStandard white = standard(text);

  EXPECT_NEAR(white.shape(at(45.0_deg, 8.0_deg, 0.0_deg), 568.0_nm), 1.0, kSixDigits);
}

TEST(ReferenceStandard, SetsTheShapeToOneAtZeroFortyFiveForACertificateOfThatGeometry) {
  ReferenceText text{.shape = [](double i, double r, double) { return 1.0 + (i + r) / 90.0; }, .shape_extra = ""};
  text.certificate = without(text.certificate, "specular");
  text.certificate.replace(text.certificate.find("8/h"), 3, "0/45");

  const ReferenceStandard white = standard(text);

  EXPECT_NEAR(white.shape(at(0.0_deg, 45.0_deg, 120.0_deg), 568.0_nm), 1.0, kSixDigits);
  EXPECT_NEAR(white.shape(at(45.0_deg, 45.0_deg, 0.0_deg), 568.0_nm), 2.0 / 1.5, kSixDigits);
}

// A cone of half angle b about a direction at 8 deg holds cos(8 deg) sin^2(b) of a hemisphere's projected solid angle.
TEST(ReferenceStandard, LeavesTheSpecularPortOutOfTheIntegral) {
  ReferenceText text;
  text.certificate.replace(text.certificate.find("included"), 8, "excluded");
  text.certificate += "specular_port_half_angle_deg = 4.0\n";

  const ReferenceStandard white = standard(text);

  const double port = std::cos(8.0 * kPi / 180.0) * std::pow(std::sin(4.0 * kPi / 180.0), 2);
  EXPECT_NEAR(white.shape(at(30.0_deg, 30.0_deg, 0.0_deg), 568.0_nm), 1.0 / (1.0 - port), 1e-9);
}

TEST(ReferenceStandard, InterpolatesLinearlyInEachAngleAndFoldsPhi) {
  ReferenceText text{.shape = [](double i, double r, double p) { return 1.0 + i * r * p / 1e6; }};
  const ReferenceStandard white = standard(text);
  const double scale = white.shape(at(0.0_deg, 0.0_deg, 0.0_deg), 568.0_nm);

  // A product of the three angles is what a trilinear rule reproduces exactly.
  const double expected = scale * (1.0 + 20.0 * 50.0 * 75.0 / 1e6);

  EXPECT_NEAR(white.shape(at(20.0_deg, 50.0_deg, 75.0_deg), 568.0_nm), expected, kSixDigits);
  EXPECT_NEAR(white.shape(at(20.0_deg, 50.0_deg, -75.0_deg), 568.0_nm), expected, kSixDigits);
  EXPECT_NEAR(white.shape(at(20.0_deg, 50.0_deg, 285.0_deg), 568.0_nm), expected, kSixDigits);
  EXPECT_NEAR(white.shape(at(-20.0_deg, 50.0_deg, 105.0_deg), 568.0_nm), expected, kSixDigits);
}

// A parabola through nodes h apart lies c t (1 - t) h^2 off its chord; the table is linear along the other two angles.
TEST(ReferenceStandard, SaysHowFarAStraightLineMayBeFromACurvedShape) {
  const double c = 1e-4;  // per square degree
  const ReferenceStandard white = standard({.shape = [&](double, double r, double) { return 1.0 + c * r * r; }});
  const double scale = white.shape(at(0.0_deg, 0.0_deg, 0.0_deg), 568.0_nm);

  EXPECT_NEAR(white.u_interpolation(at(20.0_deg, 35.0_deg, 70.0_deg), 568.0_nm), scale * c * 5.0 * 10.0, 1e-5);
  EXPECT_NEAR(white.u_interpolation(at(20.0_deg, 45.0_deg, 70.0_deg), 568.0_nm), 0.0, 1e-12);
}

// The midpoint rule over a fine grid, written out here, sees no change of the certificate's reflectance.
TEST(ReferenceStandard, ModesKeepTheReflectanceThatTheCertificateStates) {
  ReferenceText text{.shape = [](double i, double r, double p) { return 1.1 - i * r * (90.0 - p) / 1e6; }};
  text.modes =
      "[[shape.modes]]\nname = \"a\"\nkind = \"limb\"\nu = 0.01\n[[shape.modes]]\nname = \"b\"\nkind = \"forward\"\nu "
      "= "
      "0.01\n[[shape.modes]]\nname = \"c\"\nkind = \"sideways\"\nu = 0.01\n[[shape.modes]]\nname = \"d\"\nkind = "
      "\"opposition\"\nu = 0.01\nwidth_deg = 12.0\n";
  const ReferenceStandard white = standard(text);
  constexpr int kThetas = 450;
  constexpr int kPhis = 180;

  std::vector<double> change(4, 0.0);
  double whole = 0.0;
  for (int t = 0; t < kThetas; ++t) {
    for (int p = 0; p < kPhis; ++p) {
      const double theta = (t + 0.5) * kPi / 2.0 / kThetas;
      const Geometry g = at(8.0_deg, radians(theta), radians((p + 0.5) * kPi / kPhis));
      const double weight = std::sin(theta) * std::cos(theta) * (kPi / 2.0 / kThetas) * 2.0 / kPhis;
      whole += weight * white.shape(g, 568.0_nm);
      for (std::size_t k = 0; k < 4; ++k) change[k] += weight * white.shape(g, 568.0_nm) * white.mode(k, g, 568.0_nm);
    }
  }

  EXPECT_NEAR(whole, 1.0, 1e-5);
  for (const double c : change) EXPECT_NEAR(c, 0.0, 1e-5);
}

TEST(ReferenceStandard, DividesTheStatedUncertaintyByItsCoverageFactor) {
  ReferenceText relative;
  relative.certificate.replace(relative.certificate.find("absolute"), 8, "relative");

  const auto absolute = standard({}).reflectance(568.0_nm);
  const auto scaled = standard(relative).reflectance(568.0_nm);

  ASSERT_TRUE(absolute && scaled);
  EXPECT_DOUBLE_EQ(absolute->value, 0.99);
  EXPECT_DOUBLE_EQ(absolute->u, 0.003);
  EXPECT_DOUBLE_EQ(scaled->u, 0.003 * 0.99);
}

TEST(ReferenceStandard, InterpolatesBetweenEntriesButNeverAcrossALongGapNorBeyondThem) {
  ReferenceText text;
  text.certificate += "longest_gap_nm = 50.0\n";
  text.entries =
      "[[certificate.entries]]\nwavelength_nm = 500.0\nreflectance = 0.98\nuncertainty = 0.004\n"
      "[[certificate.entries]]\nwavelength_nm = 550.0\nreflectance = 0.99\nuncertainty = 0.006\n"
      "[[certificate.entries]]\nwavelength_nm = 700.0\nreflectance = 0.99\nuncertainty = 0.006\n";
  const ReferenceStandard white = standard(text);

  const auto between = white.reflectance(510.0_nm);
  const auto gap = white.reflectance(600.0_nm);
  const auto beyond = white.reflectance(701.0_nm);

  ASSERT_TRUE(between);
  EXPECT_NEAR(between->value, 0.982, 1e-12);
  EXPECT_NEAR(between->u, 0.0022, 1e-12);
  for (const auto& refused : {gap, beyond}) {
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::ReferenceOutOfReach);
    EXPECT_EQ(refused.error().where->field, "certificate.entries");
    EXPECT_GT(refused.error().where->line, 0);
  }
}

// 8/h fixes the integral of each table by itself: with s = 1 + a(lambda) theta_r both mean 1, and half way between them
// so does their mean.
TEST(ReferenceStandard, ScalesEachWavelengthsShapeByItselfAndInterpolatesBetweenThem) {
  const double mean_theta = 45.0;  // deg, of theta_r weighted with 2 sin cos
  ReferenceText text{.wavelengths_nm = {500.0, 600.0}, .spectral_shape = [](double nm, double, double r, double) {
                       return nm < 550.0 ? 2.0 : 3.0 * (1.0 + 0.01 * r);
                     }};
  const ReferenceStandard white = standard(text);
  const Geometry g = at(0.0_deg, 60.0_deg, 0.0_deg);
  const double at_600 = (1.0 + 0.01 * 60.0) / (1.0 + 0.01 * mean_theta);

  EXPECT_NEAR(white.shape(g, 500.0_nm), 1.0, kSixDigits);
  EXPECT_NEAR(white.shape(g, 600.0_nm), at_600, kSixDigits);
  EXPECT_NEAR(white.shape(g, 525.0_nm), 0.75 + 0.25 * at_600, kSixDigits);
}

TEST(ReferenceStandard, IsRefusedBeyondTheWavelengthsOfItsShapes) {
  ReferenceText text{.wavelengths_nm = {570.0, 600.0},
                     .spectral_shape = [](double, double, double, double) { return 1.0; }};

  const auto refused = standard(text).check_reach(568.0_nm, at(0.0_deg, 45.0_deg, 0.0_deg));

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::ReferenceOutOfReach);
  EXPECT_EQ(refused.error().where->field, "shape.wavelengths_nm");
}

TEST(ReferenceStandard, ATableTooFewForItsWavelengthsSaysHowManyValuesItNeeds) {
  ReferenceText text;
  text.shape_extra += "wavelengths_nm = [500, 600]\n";

  const Error error = refusal(text);

  EXPECT_EQ(error.where.value_or(InputLocation{}).field, "shape.values");
  EXPECT_NE(error.limit.find("2 wavelengths x 7 x 7 x 4 = 392"), std::string::npos) << error.limit;
}

// Errors of two entries with correlation r: the variance of their mean is (u1^2 + u2^2 + 2 r u1 u2) / 4.
TEST(ReferenceStandard, TakesTheCorrelationOfTheEntriesErrorsFromTheFile) {
  ReferenceText text;
  text.certificate += "longest_gap_nm = 100.0\ncorrelation = 0.25\n";
  text.entries =
      "[[certificate.entries]]\nwavelength_nm = 500.0\nreflectance = 0.98\nuncertainty = 0.004\n"
      "[[certificate.entries]]\nwavelength_nm = 600.0\nreflectance = 0.98\nuncertainty = 0.006\n";
  const ReferenceStandard white = standard(text);

  const auto between = white.reflectance(550.0_nm);
  const auto errors = white.certificate_errors(550.0_nm);
  const auto at_entry = white.certificate_errors(600.0_nm);

  ASSERT_TRUE(between && errors && at_entry);
  EXPECT_NEAR(between->u, std::sqrt(4e-6 + 9e-6 + 0.5 * 6e-6) / 2.0, 1e-15);
  ASSERT_EQ(errors->size(), 3U);
  EXPECT_FALSE((*errors)[0].entry);
  EXPECT_NEAR((*errors)[0].u, 0.5 * 0.0025 / 0.98, 1e-15);
  EXPECT_NEAR((*errors)[1].u, std::sqrt(0.75) * 0.001 / 0.98, 1e-15);
  EXPECT_NEAR((*errors)[2].u, std::sqrt(0.75) * 0.0015 / 0.98, 1e-15);
  EXPECT_EQ((*errors)[1].entry, std::optional<std::size_t>(0));
  EXPECT_EQ(at_entry->size(), 2U);
}

TEST(ReferenceStandard, IsRefusedAfterItsLastDayAndBeforeItsFirst) {
  const ReferenceStandard white = standard({});
  const auto day = [](int y, int m, int d) { return UtcTime(std::chrono::sys_days{std::chrono::year{y} / m / d}); };

  EXPECT_TRUE(white.check_date(day(2025, 11, 3)));
  EXPECT_TRUE(white.check_date(day(2027, 11, 3) + std::chrono::hours(23)));
  for (const UtcTime when : {day(2025, 11, 2), day(2027, 11, 4)}) {
    const auto refused = white.check_date(when);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::ReferenceExpired);
    EXPECT_EQ(refused.error().where->file, "white.toml");
    EXPECT_EQ(refused.error().where->field, "certificate.expires");
    EXPECT_GT(refused.error().where->line, 0);
  }
}

TEST(ReferenceStandard, IsRefusedAtAGeometryThatItsTableDoesNotReach) {
  const ReferenceStandard white = standard({.theta_deg = {0, 30, 60, 75}});

  EXPECT_TRUE(white.check_reach(568.0_nm, at(75.0_deg, 75.0_deg, 0.0_deg)));
  for (const Geometry& g : {at(76.0_deg, 0.0_deg, 0.0_deg), at(0.0_deg, 76.0_deg, 0.0_deg)}) {
    const auto refused = white.check_reach(568.0_nm, g);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::ReferenceOutOfReach);
    EXPECT_EQ(refused.error().where->field, "shape.values");
  }
}

TEST(ReferenceStandard, WithoutAnyOneOfWhatGivesItsNumbersMeaningIsIncomplete) {
  for (const std::string key : {"date", "expires", "geometry", "specular", "coverage_factor", "uncertainty_kind"}) {
    ReferenceText text;
    text.certificate = without(text.certificate, key + " =");

    const Error error = refusal(text);

    EXPECT_EQ(error.code, ErrorCode::ReferenceIncomplete) << key;
    EXPECT_EQ(error.where.value_or(InputLocation{}).file, "white.toml") << key;
    EXPECT_EQ(error.where.value_or(InputLocation{}).field, "certificate." + key);
    EXPECT_GT(error.where.value_or(InputLocation{}).line, 0) << key;
  }
  EXPECT_EQ(refusal({.shape_extra = ""}).code, ErrorCode::ReferenceIncomplete);
  EXPECT_EQ(refusal({.entries = ""}).code, ErrorCode::ReferenceIncomplete);
}

TEST(ReferenceStandard, RefusesATableThatDoesNotReachItsCertificatesOwnGeometry) {
  const Error error = refusal({.theta_deg = {0, 30, 60}});

  EXPECT_EQ(error.code, ErrorCode::ReferenceOutOfReach);
  EXPECT_EQ(error.where.value_or(InputLocation{}).field, "shape.theta_r_deg");
}

TEST(ReferenceStandard, RefusesATableThatVariesWithPhiAboutTheNormal) {
  const Error error = refusal({.shape = [](double, double r, double p) { return 1.0 + r * p / 1e5 + p / 1e4; }});

  EXPECT_EQ(error.code, ErrorCode::InvalidInput);
  EXPECT_EQ(error.where.value_or(InputLocation{}).field, "shape.values");
}

TEST(ReferenceStandard, RefusesAnUnknownKeyAndNamesTheNearest) {
  ReferenceText text;
  text.shape_extra += "u_integrall = 0.1\n";

  const Error error = refusal(text);

  EXPECT_EQ(error.code, ErrorCode::UnknownKey);
  EXPECT_NE(error.limit.find("u_integral"), std::string::npos);
}

}  // namespace
}  // namespace gonio::calibration
