#include "calibration/shape_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "sim/scene/papers.h"
#include "tests/calibration/reference_text.h"

namespace gonio::calibration {
namespace {

using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

ReferenceStandard parsed(const std::string& text) {
  auto standard = ReferenceStandard::parse(text, "white.toml");
  EXPECT_TRUE(standard) << describe(standard.error());
  return std::move(standard).value();
}

ShapeReport report_of(const ReferenceText& text) {
  return check_shape(parsed(text.text()));
}

double sine(double deg) {
  return std::sin(deg * kPi / 180.0);
}

// As an open model of Spectralon does (REFF, 27 parameters): gaps of 4 % at 30/60 and 10 % at 10/70, and an integral
// of 1.028 where its certificate says 0.99.
double like_the_open_model(double i, double r, double phi) {
  const double forward = 0.7 * std::pow(sine(i) * sine(r), 6) * std::pow(sine(0.5 * phi), 4);
  return 1.028 * (1.0 + forward) * std::exp(0.000825 * (r - i));
}

TEST(ShapeCheck, AFlatTableIsSoundAndSendsBackWhatItsCertificateSays) {
  const ShapeReport report = report_of({});

  EXPECT_EQ(report.verdict, ShapeVerdict::Sound);
  EXPECT_EQ(report.largest_gap, 0.0);
  ASSERT_TRUE(report.brightest);
  EXPECT_NEAR(report.brightest->reflectance, 0.99, 1e-12);
  EXPECT_TRUE(report.findings.empty());
}

TEST(ShapeCheck, CatchesATableLikeTheOpenModelAndNamesTheWorstPairAndItsSize) {
  ReferenceText text{.theta_deg = {0, 10, 30, 45, 60, 70}, .shape = like_the_open_model};
  text.modes = "[[shape.modes]]\nname = \"limb\"\nkind = \"limb\"\nu = 0.01\n";
  const ReferenceStandard white = parsed(text.text());

  const ShapeReport report = check_shape(white);
  const Result<void> demanded = demand_consistency(white, report);

  EXPECT_EQ(report.verdict, ShapeVerdict::Contradicts);
  EXPECT_NEAR(report.largest_gap, 2.0 * std::tanh(0.000825 * 70.0), 1e-5);  // 0/70
  ASSERT_FALSE(demanded);
  EXPECT_EQ(demanded.error().code, ErrorCode::InvalidInput);
  EXPECT_THAT(demanded.error().seen, HasSubstr("breaks reciprocity"));
  EXPECT_THAT(demanded.error().seen, HasSubstr("the largest gap of all is 12 %"));
  EXPECT_EQ(demanded.error().where.value_or(InputLocation{}).file, "white.toml");
  EXPECT_EQ(demanded.error().where.value_or(InputLocation{}).field, "shape.values");
  EXPECT_GT(demanded.error().where.value_or(InputLocation{}).line, 0);
}

TEST(ShapeCheck, SaysThatATableWasWrittenOnAnotherScaleThanItsCertificates) {
  const ShapeReport report = report_of({.shape = [](double, double, double) { return 1.028; }});

  EXPECT_EQ(report.verdict, ShapeVerdict::Sound);
  EXPECT_NEAR(report.as_written, 1.028, 1e-9);
  ASSERT_EQ(report.findings.size(), 1U);
  EXPECT_THAT(report.findings[0], HasSubstr("1.0280"));
}

// The values at 30/60 and 60/30 stand 2 % apart in the forward direction. The forward mode is sin 30 sin 60 = 0.433 u
// there and keeps a mean of 0: half the gap is 0.58, 1.15 and 2.26 of 0.433 u with 0.1 % in quadrature.
TEST(ShapeCheck, JudgesAGapByTheUncertaintyThatTheTablesOwnModesGiveThere) {
  const auto verdict = [](const std::string& u) {
    ReferenceText text{.shape = [](double i, double r, double phi) {
      const double half_gap = phi < 179.0 ? 0.0 : i == 30.0 && r == 60.0 ? 0.01 : i == 60.0 && r == 30.0 ? -0.01 : 0.0;
      return 1.0 + half_gap;
    }};
    text.modes = "[[shape.modes]]\nname = \"forward\"\nkind = \"forward\"\nu = " + u + "\n";
    return report_of(text).verdict;
  };

  EXPECT_EQ(verdict("0.04"), ShapeVerdict::Sound);
  EXPECT_EQ(verdict("0.02"), ShapeVerdict::Doubtful);
  EXPECT_EQ(verdict("0.01"), ShapeVerdict::Contradicts);
}

// s = (1 + a theta_i)(1 + a theta_r) is reciprocal, and rho_dh(theta_i) goes with 1 + a theta_i.
TEST(ShapeCheck, CatchesATableThatSendsBackMoreLightThanItGets) {
  const double a = 0.001;
  const ShapeReport report =
      report_of({.shape = [&](double i, double r, double) { return (1.0 + a * i) * (1.0 + a * r); }});

  EXPECT_EQ(report.verdict, ShapeVerdict::Contradicts);
  ASSERT_TRUE(report.brightest);
  EXPECT_NEAR(report.brightest->reflectance, 0.99 * 1.09 / 1.008, 1e-5);
  EXPECT_NEAR(in_degrees(report.brightest->theta), 90.0, 1e-9);
  ASSERT_FALSE(report.findings.empty());
  EXPECT_THAT(report.findings[0], HasSubstr("more light than it gets"));
}

TEST(ShapeCheck, LooksAtEachWavelengthsTable) {
  const ShapeReport report = report_of(
      {.wavelengths_nm = {450.0, 568.0, 650.0}, .spectral_shape = [](double nm, double i, double r, double phi) {
         return nm > 600.0 ? like_the_open_model(i, r, phi) : 1.0;
       }});

  EXPECT_EQ(report.verdict, ShapeVerdict::Contradicts);
  ASSERT_TRUE(report.worst_pair);
  EXPECT_NEAR(in_nanometres(report.worst_pair->wavelength), 650.0, 1e-9);
  EXPECT_THAT(report.findings.at(0), HasSubstr("at 650 nm"));
}

TEST(ShapeCheck, TheSimulatorsStandardIsReciprocalAndKeepsEnergy) {
  sim::ReferenceSpec spec{.certificate = {{nanometres(550.0), 0.9898, 0.0053}}, .u_integral = 0.001};
  spec.modes = {{.kind = sim::ModeKind::Limb, .u = 0.01}};

  const ShapeReport report = check_shape(parsed(sim::reference_toml(spec)));

  EXPECT_EQ(report.verdict, ShapeVerdict::Sound) << (report.findings.empty() ? "" : report.findings[0]);
  EXPECT_LT(report.largest_gap, 1e-4);
  ASSERT_TRUE(report.brightest);
  EXPECT_NEAR(report.brightest->reflectance, 0.9898, 0.003) << "linear interpolation of a table";
}

// What is published: 0/45 factor 1.01 to 1.02, a hot spot, forward at grazing angles; and an uncertainty that says so.
TEST(ShapeCheck, TheShippedStandardIsReciprocalAndKeepsEnergyAndIsHonestAboveSixtyDegrees) {
  std::ifstream in(std::string(GONIO_SOURCE_DIR) + "/packaging/reference/SPECTRALON-99-LITERATURE.toml");
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const ReferenceStandard white = parsed(text);

  const ShapeReport report = check_shape(white);

  EXPECT_EQ(report.verdict, ShapeVerdict::Sound) << (report.findings.empty() ? "" : report.findings[0]);
  EXPECT_TRUE(report.findings.empty());
  EXPECT_LT(report.largest_gap, 2e-4);  // the digits that are printed
  const auto at = [](double i, double r, double phi) {
    return Geometry{.theta_i = degrees(i), .phi_i = {}, .theta_r = degrees(r), .phi_r = degrees(phi)};
  };
  for (const double nm : {400.0, 550.0, 1000.0}) {
    const Wavelength wavelength = nanometres(nm);
    EXPECT_TRUE(white.check_reach(wavelength, at(70.0, 75.0, 180.0)));
    EXPECT_GE(white.shape(at(0, 45, 0), wavelength), 1.01) << nm;
    EXPECT_LE(white.shape(at(0, 45, 0), wavelength), 1.02) << nm;
    EXPECT_NEAR(white.shape(at(0, 0, 0), wavelength), 1.07, 0.02);
    EXPECT_NEAR(white.shape(at(60, 60, 180), wavelength), 1.16, 0.04);
    EXPECT_NEAR(white.shape(at(70, 70, 180), wavelength), 1.6, 0.1);
  }
  const auto u = [&](const Geometry& g) {
    double sum = 0.0;
    for (std::size_t k = 0; k < white.modes().size(); ++k) {
      sum += std::pow(white.mode(k, g, nanometres(550.0)) * white.modes()[k].u, 2);
    }
    return std::sqrt(sum);
  };
  EXPECT_LT(u(at(0, 45, 0)), 0.006);
  for (const double theta : {62.0, 70.0}) {
    for (const double phi : {0.0, 90.0, 180.0}) {
      EXPECT_GE(u(at(theta, theta, phi)), 0.02) << theta << ' ' << phi;
      EXPECT_LE(u(at(theta, theta, phi)), phi == 0.0 ? 0.08 : 0.06) << theta << ' ' << phi;  // the hot spot
    }
  }
}

}  // namespace
}  // namespace gonio::calibration
