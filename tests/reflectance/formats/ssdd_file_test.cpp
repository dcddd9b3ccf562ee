#include "reflectance/formats/ssdd_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "tests/reflectance/formats/sample_files.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;

// A second reader by the format's documentation: lists in degrees, then a line a direction, PARAM0 fastest.
struct SsddTable {
  std::vector<double> p0, p2, p3, values;
  [[nodiscard]] double at(std::size_t n0, std::size_t n2, std::size_t n3) const {
    return values.at(n0 + p0.size() * (n2 + p2.size() * n3));
  }
};

SsddTable ssdd_table(const std::string& text) {
  SsddTable table;
  std::map<std::string, std::vector<double>*> lists{
      {"PARAM0_LIST", &table.p0}, {"PARAM2_LIST", &table.p2}, {"PARAM3_LIST", &table.p3}};
  std::istringstream in(text);
  for (std::string line; std::getline(in, line) && line.rfind("DATA ", 0) != 0;) {
    std::istringstream fields(line);
    std::string key;
    fields >> key;
    if (!lists.contains(key)) continue;
    for (double value = 0.0; fields >> value;) lists[key]->push_back(value);
  }
  for (double value = 0.0; in >> value;) table.values.push_back(value);
  return table;
}

TEST(SsddFile, OfAGridHoldsEachValueAtItsOwnDirection) {
  for (MeasuredBrdf brdf : {bright_retro(), bright_aside()}) {
    brdf.points[40].f_per_sr = -0.25;
    const BrdfPoint& bright = brightest(brdf);
    const Result<SurfaceFile> surfaces = surfaces_of(brdf);
    ASSERT_TRUE(surfaces) << describe(surfaces.error());

    const Result<Export> written = write_ssdd(*surfaces, ssdd_axes_of(brdf));
    ASSERT_TRUE(written) << describe(written.error());
    const SsddTable table = ssdd_table(bytes_of(written, ".ssdd"));

    ASSERT_EQ(table.p0, (std::vector<double>{15, 30, 45, 60}));
    ASSERT_EQ(table.p3.size(), 13u) << "the turn is closed";
    ASSERT_EQ(table.values.size(), 4u * 9u * 13u);
    EXPECT_NEAR(table.at(1, static_cast<std::size_t>(bright.theta_r_deg / 10.0),
                         static_cast<std::size_t>(bright.phi_r_deg / 30.0)),
                5.0, 1e-9);
    EXPECT_EQ(std::ranges::count_if(table.values, [](double f) { return f > 4.0; }), bright.phi_r_deg == 0.0 ? 2 : 1);
    const Result<MeasuredBrdf> read = read_ssdd(bytes_of(written, ".ssdd"), "x.ssdd");
    ASSERT_TRUE(read) << describe(read.error());
    EXPECT_EQ(read->metadata.sample, brdf.metadata.sample);
    EXPECT_NEAR(std::ranges::min_element(read->points, {}, &BrdfPoint::f_per_sr)->f_per_sr, -0.25, 1e-9);
  }
}

TEST(SsddFile, OfAFormulaReadsBackAsTheFormula) {
  SurfaceFile file;
  file.channels.push_back({.channel = channel_at(450.0), .surface = reflectance::wheat()});
  file.channels.push_back(
      {.channel = channel_at(650.0), .surface = reflectance::surface("lambertian", {{"rho", 0.5}})});

  const Result<Export> written = write_ssdd(file);
  ASSERT_EQ(written->files.size(), 1u) << "a spectrum";
  const Result<MeasuredBrdf> read = read_ssdd(bytes_of(written, ".ssdd"), "x.ssdd");

  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->metadata.symmetry, reflectance::TableSymmetry::Isotropic);
  ASSERT_EQ(read->channels.size(), 2u);
  for (const BrdfPoint& p : read->points) {
    const double f = in_per_steradian(file.channels[p.channel].surface.eval(geometry_of(p)));
    EXPECT_NEAR(p.f_per_sr, f, 1e-12 * f);
  }
}

const std::string kHead = "VERSION 0.2\n# a comment\nDATA_TYPE brdf\nCOLOR_MODEL rgb\n";

TEST(SsddFile, OfOthersMayCountFromTheMirrorOrTheHalfVector) {
  const std::string specular = kHead +
                               "PARAM_TYPE specular_coordinate_system\nPARAM0_LIST 30\nPARAM2_LIST 0 60\n"
                               "PARAM3_LIST 0\nDATA ascii\n.1 .2 .3\n# PARAM2: 60\n1 2 3\n";
  const Result<MeasuredBrdf> by_mirror = read_ssdd(specular, "x.ssdd");
  ASSERT_TRUE(by_mirror) << describe(by_mirror.error());
  ASSERT_EQ(by_mirror->points.size(), 6u);
  EXPECT_LT(degrees_from_view(by_mirror->points[0], 30.0, 180.0), 1e-9);
  EXPECT_LT(degrees_from_view(by_mirror->points[3], 30.0, 0.0), 1e-9) << "60 deg towards the normal: back to the light";
  EXPECT_EQ(by_mirror->points[5].f_per_sr, 3.0);

  const std::string half =
      "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE half_difference_coordinate_system\n"
      "REDUCTION_TYPE bilateral_symmetry reciprocity\nPARAM0_LIST 0 30\nPARAM2_LIST 0 90\nPARAM3_LIST 0\n"
      "DATA ascii\n1\n2\n3\n4\n";
  const Result<MeasuredBrdf> by_half = read_ssdd(half, "x.ssdd");
  ASSERT_TRUE(by_half) << describe(by_half.error());
  ASSERT_EQ(by_half->points.size(), 3u) << "one lies below the horizon";
  EXPECT_NEAR(by_half->points[1].theta_i_deg, 30.0, 1e-12);
  EXPECT_NEAR(by_half->points[1].theta_r_deg, 30.0, 1e-12);
  EXPECT_EQ(by_half->points[1].f_per_sr, 2.0);
}

TEST(SsddFile, MayHoldItsValuesInBinary) {
  std::string bytes =
      "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\n"
      "PARAM0_LIST 0 30\nPARAM2_LIST 0\nPARAM3_LIST 0\nDATA binary\n";
  bytes += std::string("\x00\x00\x80\x3F\x00\x00\x00\xC0", 8);  // 1, -2
  const Result<MeasuredBrdf> read = read_ssdd(bytes, "x.ssdd");
  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->points[0].f_per_sr, 1.0);
  EXPECT_EQ(read->points[1].f_per_sr, -2.0);
  EXPECT_TRUE(read->metadata.remarks.empty());
  EXPECT_FALSE(read_ssdd(bytes.substr(0, bytes.size() - 1), "cut.ssdd"));
  const Result<MeasuredBrdf> followed = read_ssdd(bytes + "\nVERSION 0.2\nDATA_TYPE specular_reflectance\n", "x.ssdd");
  ASSERT_TRUE(followed) << describe(followed.error());
  EXPECT_EQ(followed->points, read->points);
  EXPECT_EQ(followed->metadata.remarks.at(0).first, "left out");
}

TEST(SsddFile, SaysThatBlocksAfterItsTextAreNotRead) {
  const std::string text =
      "VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL monochrome\nPARAM_TYPE spherical_coordinate_system\n"
      "PARAM0_LIST 0 30\nPARAM2_LIST 0\nPARAM3_LIST 0\nDATA ascii\n1\n2\n\n";
  EXPECT_TRUE(read_ssdd(text, "x.ssdd")->metadata.remarks.empty());
  EXPECT_EQ(read_ssdd(text + "DATA_TYPE specular_reflectance\n", "x.ssdd")->metadata.remarks.size(), 1u);
}

TEST(SsddFile, SaysWhereABadOneIsBad) {
  const auto said = [](const std::string& text) {
    const Result<MeasuredBrdf> read = read_ssdd(text, "bad.ssdd");
    return read ? std::string("it was read") : describe(read.error());
  };
  const std::string lists =
      "PARAM_TYPE spherical_coordinate_system\nPARAM0_LIST 0\nPARAM2_LIST 0\nPARAM3_LIST 0\nDATA ascii\n";
  EXPECT_THAT(said(""), HasSubstr("bad.ssdd"));
  EXPECT_THAT(said("Source Measured\n"), HasSubstr("VERSION"));
  EXPECT_THAT(said(kHead), HasSubstr("DATA"));
  EXPECT_THAT(said(kHead + lists), HasSubstr("fit in the file"));
  EXPECT_THAT(said(kHead + lists + "# 1 2 3\n"), HasSubstr("ends within its values"));
  EXPECT_THAT(said(kHead + lists + "1 2\n"), HasSubstr("2 numbers"));
  EXPECT_THAT(said(kHead + lists + "1 2 nan\n"), HasSubstr("bad.ssdd:10"));
  EXPECT_THAT(said("VERSION 0.2\nDATA_TYPE btdf\nDATA ascii\n"), HasSubstr("btdf"));
  EXPECT_THAT(said("VERSION 0.2\nDATA_TYPE brdf\nPARAM_TYPE x\nDATA ascii\n"), HasSubstr("PARAM_TYPE"));
  std::string falling = kHead + lists;
  falling.replace(falling.find("LIST 0"), 6, "LIST 5 5");
  EXPECT_THAT(said(falling), HasSubstr("PARAM0_LIST"));
  std::string huge = kHead + lists;
  std::string many;
  for (int n = 0; n < 90; ++n) many += " " + std::to_string(n);
  for (const char* list : {"PARAM0_LIST 0", "PARAM2_LIST 0", "PARAM3_LIST 0"})
    huge.replace(huge.find(list), 13, std::string(list).substr(0, 11) + many);
  EXPECT_THAT(said(huge), HasSubstr("fit in the file"));
}

}  // namespace
}  // namespace gonio::formats
