#include "reflectance/formats/zemax_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <sstream>

#include "tests/reflectance/formats/sample_files.h"
#include "tests/reflectance/formats/shared_data.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;
using Vec = std::array<double, 3>;

constexpr double kDegree = std::numbers::pi / 180.0;

double dot(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// A second reader by the published description: light comes from (aoi, phi 0); the mirror direction is the pole of the
// radials, azimuth 0 points from it to the normal, azimuths run counter-clockwise. Plain vectors, no code of ours.
struct SeenByOthers {
  double brightest = -1.0;
  Vec direction{};
  double aoi = 0.0;
  std::size_t values = 0;
};

std::vector<double> axis_after(std::istream& in) {
  std::size_t count = 0;
  in >> count;
  std::vector<double> values(count);
  for (double& value : values) in >> value;
  return values;
}

SeenByOthers read_by_others(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> aoi, azimuth, radial;
  SeenByOthers seen;
  for (std::string word; in >> word && word != "DataBegin";) {
    if (word == "AngleOfIncidence") aoi = axis_after(in);
    if (word == "ScatterAzimuth") azimuth = axis_after(in);
    if (word == "ScatterRadial") radial = axis_after(in);
  }
  for (const double a : aoi) {
    std::string word;
    double tis = 0.0;
    in >> word >> tis;
    EXPECT_EQ(word, "TIS");
    const Vec pole{-std::sin(a * kDegree), 0.0, std::cos(a * kDegree)};
    const Vec towards{std::cos(a * kDegree), 0.0, std::sin(a * kDegree)};  // from the pole to the normal
    const Vec aside = cross(pole, towards);
    for (const double z : azimuth) {
      for (const double r : radial) {
        double value = 0.0;
        in >> value;
        ++seen.values;
        if (value <= seen.brightest) continue;
        seen.brightest = value;
        seen.aoi = a;
        for (std::size_t n = 0; n < 3; ++n)
          seen.direction[n] =
              std::cos(r * kDegree) * pole[n] +
              std::sin(r * kDegree) * (std::cos(z * kDegree) * towards[n] + std::sin(z * kDegree) * aside[n]);
      }
    }
  }
  return seen;
}

double degrees_between(const Vec& a, double theta, double phi) {
  const Vec b{std::sin(theta * kDegree) * std::cos(phi * kDegree), std::sin(theta * kDegree) * std::sin(phi * kDegree),
              std::cos(theta * kDegree)};
  return std::acos(std::min(1.0, dot(a, b))) / kDegree;
}

ZemaxAxes fine_axes() {
  ZemaxAxes axes{.incidences = {15, 30, 45, 60}, .azimuths = {}, .radials = {}};
  for (double azimuth = 0.0; azimuth <= 360.0; azimuth += 5.0) axes.azimuths.push_back(azimuth);
  for (double radial = 0.0; radial <= 150.0; radial += 2.5) axes.radials.push_back(radial);
  return axes;
}

TEST(ZemaxFile, HoldsABrightReadingWhereItWas) {
  for (const MeasuredBrdf& brdf : {bright_retro(), bright_aside()}) {
    const BrdfPoint& bright = brightest(brdf);
    const Result<SurfaceFile> surfaces = surfaces_of(brdf);
    ASSERT_TRUE(surfaces) << describe(surfaces.error());
    const Result<Export> written = write_zemax(*surfaces, fine_axes());
    ASSERT_TRUE(written) << describe(written.error());

    const SeenByOthers seen = read_by_others(bytes_of(written, ".bsdf"));

    EXPECT_EQ(seen.values, 4u * 73u * 61u);
    EXPECT_EQ(seen.aoi, 30.0);
    EXPECT_GT(seen.brightest, 3.0);
    EXPECT_LT(degrees_between(seen.direction, bright.theta_r_deg, bright.phi_r_deg), 2.5) << "half a step of the axes";
    EXPECT_TRUE(has_loss(written->losses, LossKind::Resampled));
    EXPECT_TRUE(has_loss(written->losses, LossKind::Uncertainty));
  }
}

TEST(ZemaxFile, OfAFormulaReadsBackAsTheFormula) {
  const reflectance::Surface wheat = reflectance::wheat();
  SurfaceFile file;
  file.channels.push_back({.channel = channel_at(550.0), .surface = wheat});

  const Result<Export> written = write_zemax(file);
  const Result<MeasuredBrdf> read = read_zemax(bytes_of(written, ".bsdf"), "wheat.bsdf");

  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->metadata.symmetry, reflectance::TableSymmetry::Isotropic);
  ASSERT_GT(read->points.size(), 2000u);
  for (const BrdfPoint& point : read->points) {
    const double f = in_per_steradian(wheat.eval(geometry_of(point)));
    EXPECT_NEAR(point.f_per_sr, f, 1e-6 * f) << point.theta_i_deg << " " << point.theta_r_deg << " " << point.phi_r_deg;
  }
  EXPECT_TRUE(written->losses.empty());
}

// rho/pi everywhere: TIS is rho.
TEST(ZemaxFile, TellsTheTotalScatter) {
  SurfaceFile file;
  file.channels.push_back({.channel = {}, .surface = reflectance::surface("lambertian", {{"rho", 0.4}})});
  EXPECT_THAT(bytes_of(write_zemax(file), ".bsdf"), HasSubstr("TIS\t0.400000\n"));
}

TEST(ZemaxFile, OfOthersIsRead) {
  const std::optional<std::string> text = file_content(shared_folder() / "data/measured/anoblack-ec1.zemax.bsdf");
  if (!text) {
    std::cout << "no measured data in " << shared_folder() << ": nothing checked\n";
    return;
  }
  const Result<MeasuredBrdf> read = read_zemax(*text, "anoblack-ec1.zemax.bsdf");

  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_THAT(read->metadata.sample, HasSubstr("AnoBlack EC1"));
  EXPECT_EQ(read->metadata.symmetry, reflectance::TableSymmetry::Isotropic);
  // Its first row is lit from 10 deg: the mirror direction, then 5 deg from there towards the normal.
  EXPECT_EQ(read->points[0].f_per_sr, 3.480e-02);
  EXPECT_NEAR(read->points[0].theta_r_deg, 10.0, 1e-12);
  EXPECT_NEAR(read->points[0].phi_r_deg, 180.0, 1e-12);
  EXPECT_EQ(read->points[1].f_per_sr, 3.355e-02);
  EXPECT_NEAR(read->points[1].theta_r_deg, 5.0, 1e-12);
  EXPECT_NEAR(read->points[1].phi_r_deg, 180.0, 1e-9);
  EXPECT_EQ(std::ranges::count(read->points, 0.0, &BrdfPoint::f_per_sr), 0) << "it fills rows up with zeros";
  const Result<SurfaceFile> surfaces = surfaces_of(*read);
  ASSERT_TRUE(surfaces) << describe(surfaces.error());
  const Result<Export> again = write_zemax(*surfaces);
  ASSERT_TRUE(again) << describe(again.error());
}

TEST(ZemaxFile, TakesZerosAtTheEndOfARowForNoReading) {
  const std::string text =
      "Source\tMeasured\nSymmetry\tPlaneSymmetrical\nSpectralContent\tMonochrome\nScatterType\tBRDF\n"
      "SampleRotation\t1\n0\nAngleOfIncidence\t1\n0\nScatterAzimuth\t3\n0\t90\t180\nScatterRadial\t4\n0\t20\t40\t60\n"
      "Monochrome\nDataBegin\nTIS\t0.3\n.1\t0\t.3\t0\n.1\t.2\t0\t0\n0\t0\t0\t0\nDataEnd\n";

  const Result<MeasuredBrdf> read = read_zemax(text, "x.bsdf");

  ASSERT_TRUE(read) << describe(read.error());
  std::vector<double> values;
  for (const BrdfPoint& p : read->points) values.push_back(p.f_per_sr);
  EXPECT_THAT(values, testing::ElementsAre(0.1, 0.0, 0.3, 0.2, 0.0, 0.0, 0.0))
      << "between values 0 is one, as in a row of it";
  EXPECT_THAT(read->metadata.remarks.back().second, HasSubstr("3 zeros"));
}

TEST(ZemaxFile, SaysWhereABadOneIsBad) {
  SurfaceFile file;
  file.channels.push_back({.channel = {}, .surface = reflectance::surface("lambertian", {{"rho", 0.4}})});
  const std::string good = bytes_of(write_zemax(file), ".bsdf");
  const auto said = [&](const std::string& from, const std::string& to) {
    std::string bad = good;
    bad.replace(bad.find(from), from.size(), to);
    const Result<MeasuredBrdf> read = read_zemax(bad, "bad.bsdf");
    return read ? std::string("it was read") : describe(read.error());
  };
  EXPECT_THAT(said("BRDF", "BTDF"), HasSubstr("bad.bsdf:8"));
  EXPECT_THAT(said("ScatterRadial\t", "ScatterRadial\t9"), HasSubstr("numbers"));
  EXPECT_THAT(said("AngleOfIncidence\t9", "AngleOfIncidence\t99999999999"), HasSubstr("AngleOfIncidence"));
  EXPECT_THAT(said("TIS", "T"), HasSubstr("TIS"));
  EXPECT_THAT(said("1.273240e-01", "nan"), HasSubstr("finite"));
  EXPECT_THAT(said("DataEnd", ""), HasSubstr("DataEnd"));
  EXPECT_THAT(said("Source", "tensor_file"), HasSubstr("Source"));
  for (std::size_t length = 0; length + 9 < good.size(); length += 97)
    EXPECT_FALSE(read_zemax(good.substr(0, length), "cut.bsdf")) << length;
  EXPECT_FALSE(write_zemax({})) << "no channel";
  EXPECT_FALSE(write_zemax(file, {.incidences = {30, 20}}));
}

}  // namespace
}  // namespace gonio::formats
