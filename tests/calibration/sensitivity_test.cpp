// Each sensitivity of the budget against the value itself, computed twice with the input moved (JCGM 100:2008, 5.1.3).
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "calibration/calibrate.h"
#include "tests/calibration/reference_text.h"
#include "tests/calibration/scan_builder.h"

namespace gonio::calibration {
namespace {

constexpr double kPi = std::numbers::pi;
const UtcTime kToday{std::chrono::sys_days{std::chrono::year{2026} / 3 / 1}};
constexpr std::size_t kMiddle = 13;  // the point in the middle of the 3 x 3 x 3 grid

/// What may be wrong, all 0 by default; the readings are made with it, and calibrated without.
struct Wrong {
  Geometry zeros{};
  double exposure_offset_s = 0.0;
  double nonlinearity = 0.0;  ///< net (1 + this net / full scale)
  double dark_before_dn = 0.0;
};

double sample_brdf(const Geometry& g) {
  return 0.1 * std::exp(0.6 * g.theta_i.si() + 0.8 * g.theta_r.si() + 0.3 * g.phi_r.si());
}

// The standard's shape depends on each angle; values at the table's nodes, which a trilinear rule keeps between them.
double shape(double i_deg, double r_deg, double phi_deg) {
  return 1.0 + i_deg * 2e-3 + r_deg * 1e-3 + i_deg * r_deg * phi_deg * 1e-7;
}

const char* const kModes =
    "[[shape.modes]]\nname = \"a\"\nkind = \"limb\"\nu = 0.01\n[[shape.modes]]\nname = \"b\"\nkind = \"forward\"\nu = "
    "0.02\n";

ReferenceStandard standard(double reflectance = 0.99) {
  ReferenceText text;
  text.shape = shape;
  text.modes = kModes;
  text.entries = "[[certificate.entries]]\nwavelength_nm = 568.0\nreflectance = " + std::to_string(reflectance) +
                 "\nuncertainty = 0.006\n";
  auto parsed = ReferenceStandard::parse(text.text(), "white.toml");
  EXPECT_TRUE(parsed) << describe(parsed.error());
  return std::move(parsed).value();
}

InstrumentModel instrument() {
  return {.detector = {.electrons_per_dn = 4.0,
                       .read_noise_dn = 1.5,
                       .exposure_offset_s = {.value = 0.0, .u = 2e-5},
                       .u_linearity = 0.002},
          .angles = {.u_zero_theta_i = degrees(0.02), .u_zero_theta_r = degrees(0.03), .u_zero_phi_r = degrees(0.04)}};
}

ScanReadings readings(const Wrong& wrong) {
  ScanBuilder builder({0.02, 0.01});
  const ReferenceStandard white = standard();
  builder.add_dark(0.0, ScanBuilder::kDarkDn + wrong.dark_before_dn);
  const auto net = [&](double f, const Geometry& g, double exposure_s) {
    const double dn = 4e5 * f * std::cos(g.theta_i.si()) * (exposure_s + wrong.exposure_offset_s);
    return dn * (1.0 + wrong.nonlinearity * dn / 4095.0);
  };
  double at_s = 0.0;
  for (const double i : {20.0, 25.0, 30.0}) {
    for (const double r : {35.0, 40.0, 45.0}) {
      for (const double phi : {65.0, 70.0, 75.0}) {
        const auto point = builder.add_point(directions(i, r, phi));
        Geometry g = directions(i, r, phi);
        g.theta_i += wrong.zeros.theta_i;
        g.theta_r += wrong.zeros.theta_r;
        g.phi_r += wrong.zeros.phi_r;
        builder.add_item(Target::Sample, point, at_s += 1.0, 0.02, net(sample_brdf(g), g, 0.02));
        const double f_ref = 0.99 / kPi * white.shape(g, nanometres(568.0));
        builder.add_item(Target::Reference, point, at_s += 1.0, 0.01, net(f_ref, g, 0.01));
      }
    }
  }
  builder.add_dark(100.0);
  return builder.scan();
}

CalibratedScan calibrated(const Wrong& wrong, const ReferenceStandard& white = standard()) {
  auto scan = calibrate(readings(wrong), instrument(), white, kToday);
  EXPECT_TRUE(scan) << describe(scan.error());
  return std::move(scan).value();
}

double term(const CalibratedScan& scan, std::string_view name) {
  for (const BudgetTerm& t : scan.points[kMiddle].budget.shared) {
    if (scan.components[t.component].name == name) return t.per_sd.si();
  }
  ADD_FAILURE() << "no component " << name;
  return 0.0;
}

double value(const CalibratedScan& scan) {
  return scan.points[kMiddle].value.si();
}

TEST(Sensitivity, ScanIsCalibratedToItsOwnSurface) {
  EXPECT_NEAR(value(calibrated({})), sample_brdf(directions(25.0, 40.0, 70.0)), 1e-7);
}

TEST(Sensitivity, ToTheZeroOfEachArmIsTheDifferenceQuotient) {
  const CalibratedScan scan = calibrated({});
  const Wrong theta_i{.zeros = {.theta_i = degrees(0.02)}};
  const Wrong theta_r{.zeros = {.theta_r = degrees(0.03)}};
  const Wrong phi_r{.zeros = {.phi_r = degrees(0.04)}};

  // To first order: the second-order part of such an angle is 1e-3 of the first.
  for (const auto& [wrong, name] :
       {std::pair{theta_i, "zero theta_i"}, {theta_r, "zero theta_r"}, {phi_r, "zero phi_r"}}) {
    const double change = value(calibrated(wrong)) - value(scan);
    EXPECT_NEAR(term(scan, name), change, 5e-3 * std::abs(change)) << name;
  }
}

TEST(Sensitivity, ToTheExposureOffsetIsTheDifferenceQuotient) {
  const CalibratedScan scan = calibrated({});

  const double change = value(calibrated({.exposure_offset_s = 2e-5})) - value(scan);

  EXPECT_NEAR(-term(scan, "exposure offset"), change, 3e-3 * std::abs(change));
}

TEST(Sensitivity, ToTheLinearityIsTheDifferenceQuotient) {
  const CalibratedScan scan = calibrated({});

  const double change = value(calibrated({.nonlinearity = 0.002})) - value(scan);

  EXPECT_NEAR(term(scan, "linearity"), change, 3e-3 * std::abs(change));
}

TEST(Sensitivity, ToADarkVisitIsTheDifferenceQuotient) {
  const CalibratedScan scan = calibrated({});
  const double u_dark = 1.5 / 10.0;  // read noise over the root of 100 pixels

  const double change = value(calibrated({.dark_before_dn = u_dark})) - value(scan);

  const double both = term(scan, "dark visit 1 at 20000 us") + term(scan, "dark visit 1 at 10000 us");
  EXPECT_NEAR(both, change, 3e-3 * std::abs(change));
}

TEST(Sensitivity, ToTheCertificateIsTheDifferenceQuotient) {
  const CalibratedScan scan = calibrated({});

  const double change = value(calibrated({}, standard(0.99 + 0.003))) - value(scan);

  EXPECT_NEAR(term(scan, "certificate"), change, 1e-9);
}

// The real shape has an amplitude of one standard deviation of each mode: the table's values would be off by its
// sensitivity.
TEST(Sensitivity, ToAShapeModeIsWhatATableWithThatModeInItWouldGive) {
  const CalibratedScan scan = calibrated({});
  const double u_limb = 0.01;
  ReferenceText bent;
  bent.theta_deg.clear();
  for (int deg = 0; deg <= 90; deg += 5) bent.theta_deg.push_back(deg);
  bent.phi_deg.clear();
  for (int deg = 0; deg <= 180; deg += 10) bent.phi_deg.push_back(deg);
  ReferenceText straight = bent;
  straight.shape = shape;
  bent.shape = [&](double i, double r, double phi) {
    const double limb = 0.5 * (std::pow(std::sin(i * kPi / 180.0), 4) + std::pow(std::sin(r * kPi / 180.0), 4));
    return shape(i, r, phi) * (1.0 + u_limb * limb);
  };

  const double with_mode = value(calibrated({}, ReferenceStandard::parse(bent.text(), "bent.toml").value()));
  const double without = value(calibrated({}, ReferenceStandard::parse(straight.text(), "straight.toml").value()));

  const double change = with_mode - without;
  EXPECT_NEAR(term(scan, "shape mode a"), change, 0.02 * std::abs(change));  // the bent table is linear between 5 deg
}

}  // namespace
}  // namespace gonio::calibration
