#include "calibration/import_reference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/calibration/reference_text.h"

namespace gonio::calibration {
namespace {

using namespace gonio::literals;
using testing::HasSubstr;

const std::string kCertificate =
    "# From the institute's letter of March.\n"
    "# serial: SRT-99-033\n"
    "# material: Spectralon 99 %\n"
    "# date: 2026-03-01\n"
    "# expires: 2028-03-01\n"
    "# geometry: 8/h\n"
    "# specular: included\n"
    "# coverage_factor: 2\n"
    "# uncertainty_kind: absolute\n"
    "# longest_gap_nm: 100\n"
    "# correlation: 0.5\n"
    "wavelength_nm,reflectance_percent,uncertainty_percent\n"
    "500, 98.9, 0.53\n"
    "600, 99.0, 0.49\n";

const std::string kShape =
    "# u_integral: 0.002\n"
    "# mode: limb limb 0.03\n"
    "# mode: hot-spot opposition 0.02 5\n"
    "theta_i_deg,theta_r_deg,phi_deg,factor\n"
    "0,0,0,1.00\n"
    "0,45,0,0.98\n"
    "0,80,0,0.90\n"
    "45,0,0,0.98\n"
    "45,45,0,1.00\n"
    "45,45,180,0.99\n"
    "45,80,0,0.93\n"
    "45,80,180,0.95\n"
    "80,0,0,0.90\n"
    "80,45,0,0.93\n"
    "80,45,180,0.95\n"
    "80,80,0,0.92\n"
    "80,80,180,1.10\n";

ReferenceSource both() {
  return {.text = kCertificate, .file = "letter.csv", .shape_text = kShape, .shape_file = "shape.csv"};
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

void expect_refused(const ReferenceSource& source, ErrorCode code, const InputLocation& where) {
  const auto imported = import_reference(source);
  ASSERT_FALSE(imported) << "it was taken";
  EXPECT_EQ(imported.error().code, code) << describe(imported.error());
  EXPECT_EQ(imported.error().where.value_or(InputLocation{}), where) << describe(imported.error());
}

TEST(ImportReference, MakesAStandardOfACertificateAndAShapeAsCsv) {
  const auto imported = import_reference(both());

  ASSERT_TRUE(imported) << describe(imported.error());
  const ReferenceStandard& standard = imported->standard;
  EXPECT_EQ(standard.serial(), "SRT-99-033");
  EXPECT_EQ(standard.certificate().expires, "2028-03-01");
  EXPECT_EQ(standard.certificate().correlation, 0.5);
  EXPECT_NEAR(standard.reflectance(500.0_nm)->value, 0.989, 1e-12);
  EXPECT_NEAR(standard.reflectance(500.0_nm)->u, 0.0053 / 2.0, 1e-12);
  ASSERT_EQ(standard.modes().size(), 2U);
  EXPECT_EQ(standard.modes()[1].name, "hot-spot");
  EXPECT_NEAR(in_degrees(standard.modes()[1].width), 5.0, 1e-12);
  EXPECT_EQ(standard.u_integral(), 0.002);
  const auto factor = [&](double i, double r, double phi) {
    return standard.shapes().front().table.value(
        {.theta_i = degrees(i), .phi_i = {}, .theta_r = degrees(r), .phi_r = degrees(phi)});
  };
  EXPECT_DOUBLE_EQ(factor(80, 45, 180), 0.95);
  EXPECT_DOUBLE_EQ(factor(0, 80, 180), 0.90);  // one row for all phi about the normal
  EXPECT_EQ(imported->shape.verdict, ShapeVerdict::Sound);
}

TEST(ImportReference, TheTextItMakesReadsBackAsTheSameStandard) {
  const auto imported = import_reference(both());
  ASSERT_TRUE(imported) << describe(imported.error());

  const auto again = import_reference({.text = imported->text, .file = "SRT-99-033.toml"});

  ASSERT_TRUE(again) << describe(again.error());
  EXPECT_EQ(again->text, imported->text);
  EXPECT_EQ(again->standard.shapes().front().table.values(), imported->standard.shapes().front().table.values());
}

TEST(ImportReference, KeepsAWholeFileAsItWasWritten) {
  const std::string text = "# by hand\n" + ReferenceText{}.text();

  const auto imported = import_reference({.text = text, .file = "mine.toml"});

  ASSERT_TRUE(imported) << describe(imported.error());
  EXPECT_EQ(imported->text, text);
}

TEST(ImportReference, BorrowsTheShapeOfAnotherStandard) {
  const auto other = import_reference(both());
  ASSERT_TRUE(other) << describe(other.error());

  const auto imported =
      import_reference({.text = replaced(kCertificate, "033", "034"), .file = "b.CSV", .shape_from = &other->standard});

  ASSERT_TRUE(imported) << describe(imported.error());
  EXPECT_EQ(imported->standard.serial(), "SRT-99-034");
  const Geometry g{.theta_i = 45.0_deg, .phi_i = {}, .theta_r = 80.0_deg, .phi_r = 180.0_deg};
  EXPECT_DOUBLE_EQ(imported->standard.shape(g, 500.0_nm), other->standard.shape(g, 500.0_nm));
}

TEST(ImportReference, ACertificateOfZeroFortyFiveTakesAShapeWithoutItsIntegral) {
  const auto other = import_reference(both());
  ASSERT_TRUE(other) << describe(other.error());
  std::string text = replaced(kCertificate, "geometry: 8/h", "geometry: 0/45");
  text = replaced(text, "# specular: included\n", "");

  const auto imported = import_reference({.text = text, .file = "c.csv", .shape_from = &other->standard});

  ASSERT_TRUE(imported) << describe(imported.error());
  EXPECT_NEAR(imported->standard.shape({.theta_r = 45.0_deg}, 500.0_nm), 1.0, 1e-12);
}

TEST(ImportReference, BadInputIsNamedByTheUsersFileLineAndField) {
  const auto certificate = [](const std::string& what, const std::string& by) {
    ReferenceSource source = both();
    source.text = replaced(source.text, what, by);
    return source;
  };
  const auto shape = [](const std::string& what, const std::string& by) {
    ReferenceSource source = both();
    source.shape_text = replaced(source.shape_text, what, by);
    return source;
  };
  using enum ErrorCode;
  expect_refused(certificate("99.0", "99,0"), InvalidInput, {"letter.csv", 14, ""});
  expect_refused(certificate("99.0", "99.O"), InvalidInput, {"letter.csv", 14, "reflectance_percent"});
  expect_refused(certificate("600, 99.0", "600, 990"), InvalidInput, {"letter.csv", 14, "reflectance_percent"});
  expect_refused(certificate("600,", "400,"), InvalidInput, {"letter.csv", 14, "wavelength_nm"});
  expect_refused(certificate("expires: 2028", "expires: 2025"), InvalidInput, {"letter.csv", 5, "expires"});
  expect_refused(certificate("2028-03-01", "2028-13-01"), InvalidInput, {"letter.csv", 5, "expires"});
  expect_refused(certificate("2028-03-01", "1 March"), InvalidInput, {"letter.csv", 5, "expires"});
  expect_refused(certificate("geometry: 8/h", "geometry: 8/d"), InvalidInput, {"letter.csv", 6, "geometry"});
  expect_refused(certificate("correlation", "corelation"), UnknownKey, {"letter.csv", 11, "corelation"});
  expect_refused(certificate("# serial: SRT-99-033\n", ""), MissingKey, {"letter.csv", 11, "serial"});
  expect_refused(certificate("# coverage_factor: 2\n", ""), ReferenceIncomplete,
                 {"letter.csv", 11, "certificate.coverage_factor"});
  expect_refused(certificate("uncertainty_percent", "u"), UnknownKey, {"letter.csv", 12, "u"});
  expect_refused(shape("80,80,180,1.10\n", ""), InvalidInput, {"shape.csv", 0, "factor"});
  expect_refused(shape("80,80,180", "80,80,0"), InvalidInput, {"shape.csv", 17, "factor"});
  expect_refused(shape("mode: limb limb", "mode: limb rim"), InvalidInput, {"shape.csv", 2, "mode"});
  expect_refused(shape("# u_integral: 0.002\n", ""), ReferenceIncomplete, {"shape.csv", 3, "shape.u_integral"});
}

TEST(ImportReference, ACertificateWithoutAShapeIsIncomplete) {
  expect_refused({.text = kCertificate, .file = "letter.csv"}, ErrorCode::ReferenceIncomplete,
                 {"letter.csv", 0, "shape"});
}

TEST(ImportReference, AWholeFileTakesNoSecondShape) {
  expect_refused({.text = ReferenceText{}.text(), .file = "a.toml", .shape_text = kShape, .shape_file = "shape.csv"},
                 ErrorCode::InvalidInput, {"a.toml", 0, "shape"});
}

}  // namespace
}  // namespace gonio::calibration
