#include "reflectance/formats/astm_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <sstream>

#include "tests/reflectance/formats/sample_files.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;

struct AstmLine {
  double theta_i, phi_i, theta_s, phi_s, value;
};

// A second reader by the description alone: what follows VARS are lines of five numbers, radians and sr^-1.
std::vector<AstmLine> astm_lines(const std::string& text) {
  std::istringstream in(text);
  std::string line;
  while (std::getline(in, line) && line.rfind("VARS", 0) != 0) continue;
  std::vector<AstmLine> found;
  while (std::getline(in, line)) {
    AstmLine a{};
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf", &a.theta_i, &a.phi_i, &a.theta_s, &a.phi_s, &a.value) == 5)
      found.push_back(a);
  }
  return found;
}

TEST(AstmFile, IsReadByASecondReader) {
  for (const MeasuredBrdf& brdf : {bright_retro(), bright_aside()}) {
    const BrdfPoint& bright = brightest(brdf);
    const std::vector<AstmLine> lines = astm_lines(bytes_of(write_astm(brdf), ".astm"));

    ASSERT_EQ(lines.size(), brdf.points.size());
    constexpr double kDegree = std::numbers::pi / 180.0;
    const auto found = std::ranges::max_element(lines, {}, &AstmLine::value);
    EXPECT_EQ(found->value, 5.0);
    EXPECT_NEAR(found->theta_i, 30.0 * kDegree, 1e-15);
    EXPECT_NEAR(found->phi_i, 0.0, 1e-15);
    EXPECT_NEAR(found->theta_s, bright.theta_r_deg * kDegree, 1e-15);
    EXPECT_NEAR(found->phi_s, bright.phi_r_deg * kDegree, 1e-15);
  }
}

TEST(AstmFile, KeepsValuesAndDirections) {
  MeasuredBrdf brdf = bright_aside();
  brdf.points[9].f_per_sr = -1.0 / 3.0;
  const Result<Export> written = write_astm(brdf);
  const Result<MeasuredBrdf> read = read_astm(bytes_of(written, ".astm"), "x.astm");

  ASSERT_TRUE(read) << describe(read.error());
  ASSERT_EQ(read->points.size(), brdf.points.size());
  EXPECT_EQ(read->channels, brdf.channels);
  EXPECT_EQ(read->metadata.sample, brdf.metadata.sample);
  for (std::size_t n = 0; n < brdf.points.size(); ++n) {
    EXPECT_EQ(read->points[n].f_per_sr, brdf.points[n].f_per_sr);
    EXPECT_NEAR(read->points[n].theta_r_deg, brdf.points[n].theta_r_deg, 1e-13);
    EXPECT_NEAR(read->points[n].phi_r_deg, brdf.points[n].phi_r_deg, 1e-12);
  }
  EXPECT_TRUE(has_loss(written->losses, LossKind::Uncertainty));
  EXPECT_FALSE(has_loss(written->losses, LossKind::Flags)) << "there were none to lose";
}

TEST(AstmFile, OfSeveralChannelsIsSeveralFiles) {
  MeasuredBrdf brdf = bright_retro();
  brdf.channels = {channel_at(450.5), {.name = "R"}, {.name = "a/b"}};
  for (std::size_t n = 0; n < brdf.points.size(); ++n) brdf.points[n].channel = static_cast<std::uint32_t>(n % 3);

  const Result<Export> written = write_astm(brdf);

  ASSERT_EQ(written->files.size(), 3u);
  EXPECT_EQ(written->files[0].suffix, "-450.5nm.astm");
  EXPECT_EQ(written->files[1].suffix, "-R.astm");
  EXPECT_EQ(written->files[2].suffix, "-a-b.astm");
}

TEST(AstmFile, OfOthersHasAColumnAChannel) {
  const std::string text =
      "ASTM E1392-96(2002)\r\nKEY1 a value\r\nNUM_POINTS 2\r\nVARS theta_i,phi_i,theta_s,phi_s,R,G,B\r\n"
      "0.5,0,0.5,3.14159265,0.1,0.2,0.3\r\n0.5,0,0.25,0,1e-3,2e-3,-3e-3\r\n\r\n";
  const Result<MeasuredBrdf> read = read_astm(text, "theirs.astm");

  ASSERT_TRUE(read) << describe(read.error());
  ASSERT_EQ(read->points.size(), 6u);
  EXPECT_EQ(read->channels[2].name, "B");
  EXPECT_EQ(read->points[5].f_per_sr, -3e-3);
  EXPECT_EQ(read->points[5].channel, 2u);
  EXPECT_NEAR(read->points[0].phi_r_deg, 180.0, 1e-6);
  EXPECT_EQ(read->metadata.remarks[0].second, "a value");
}

TEST(AstmFile, TakesHalfPiAsOthersRoundIt) {
  const Result<MeasuredBrdf> read =
      read_astm("VARS theta_i,phi_i,theta_s,phi_s,x\n0.5,0,1.5707964,0,1\n", "theirs.astm");
  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->points[0].theta_r_deg, 90.0);
}

TEST(AstmFile, SaysWhereABadOneIsBad) {
  const std::string head = "NUM_POINTS 1\nVARS theta_i,phi_i,theta_s,phi_s,550nm\n";
  const auto said = [](const std::string& text) {
    const Result<MeasuredBrdf> read = read_astm(text, "bad.astm");
    return read ? std::string("it was read") : describe(read.error());
  };
  EXPECT_THAT(said(""), HasSubstr("VARS"));
  EXPECT_THAT(said("\x5a\0\0\0"), HasSubstr("VARS"));
  EXPECT_THAT(said("VARS theta_i,phi_i,theta_s,phi_s\n"), HasSubstr("4 columns"));
  EXPECT_THAT(said("VARS theta_i,phi_s,theta_s,phi_i,x\n"), HasSubstr("phi_i"));
  EXPECT_THAT(said(head), HasSubstr("0 lines"));
  EXPECT_THAT(said(head + "0,0,0,0,nan\n"), HasSubstr("bad.astm:3"));
  EXPECT_THAT(said(head + "0,0,0,0\n"), HasSubstr("4 cells"));
  EXPECT_THAT(said(head + "2,0,0,0,1\n"), HasSubstr("theta_i_deg"));
  EXPECT_THAT(said("NUM_POINTS 99999999999999999999\n" + head), HasSubstr("NUM_POINTS"));
}

}  // namespace
}  // namespace gonio::formats
