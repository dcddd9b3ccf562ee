#include "reflectance/formats/alta_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>

#include "reflectance/formats/astm_file.h"
#include "reflectance/formats/surface_file.h"
#include "tests/reflectance/formats/sample_files.h"
#include "tests/reflectance/formats/shared_data.h"

namespace gonio::formats {
namespace {

using testing::HasSubstr;

constexpr const char* kThirty = "0.52359877559829887";

// One bright reading at (30, 30, 0) in each way that ALTA has of writing it.
TEST(AltaFile, FindsTheBrightReadingInEveryParameterisation) {
  const std::string t = kThirty;
  struct Row {
    std::string header;
    std::string row;
  };
  for (const Row& row :
       {Row{"#DIM 4 1\n#PARAM_IN SPHERICAL_TL_PL_TV_PV\n", t + " 0 " + t + " 0 5"},
        Row{"#DIM 3 1\n#PARAM_IN ISOTROPIC_TV_TL_DPHI\n", t + " " + t + " 0 5"},
        Row{"#DIM 3 1\n#PARAM_IN ISOTROPIC_TL_TV_PROJ_DPHI\n", t + " " + t + " 0 5"},
        Row{"#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n", t + " 0 0 5"},
        Row{"#DIM 4 1\n#PARAM_IN RUSIN_TH_PH_TD_PD\n", t + " 0 0 0 5"},
        Row{"#DIM 6 1\n#PARAM_IN CARTESIAN\n", "0.5 0 0.8660254037844386 0.5 0 0.8660254037844386 5"}}) {
    SCOPED_TRACE(row.header);
    const Result<MeasuredBrdf> read = read_alta(row.header + "#PARAM_OUT INV_STERADIAN\n" + row.row + "\n", "x.alta");
    ASSERT_TRUE(read) << describe(read.error());
    ASSERT_EQ(read->points.size(), 1u);
    EXPECT_NEAR(read->points[0].theta_i_deg, 30.0, 1e-6);
    EXPECT_LT(degrees_from_view(read->points[0], 30.0, 0.0), 1e-6);
    EXPECT_EQ(read->points[0].f_per_sr, 5.0);
  }
}

TEST(AltaFile, TellsLightFromView) {
  const Result<MeasuredBrdf> read = read_alta("#DIM 3 1\n#PARAM_IN ISOTROPIC_TV_TL_DPHI\n0.1 0.2 0.5 7\n", "x.alta");
  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_NEAR(read->points[0].theta_r_deg, 5.729577951308232, 1e-12);
  EXPECT_NEAR(read->points[0].theta_i_deg, 11.459155902616464, 1e-12);
  EXPECT_NEAR(read->points[0].phi_r_deg, 28.64788975654116, 1e-12);
}

TEST(AltaFile, TakesVerticalSegmentsForUncertainties) {
  const std::string head =
      "#ALTA HEADER\n#DIM 3 2\n#PARAM_IN RUSIN_TH_TD_PD\n#PARAM_OUT INV_STERADIAN\n#VS 1 2\n#ALTA END HEADER\n";
  const Result<MeasuredBrdf> read = read_alta(head + "0.5 0.1 0 1.5 2.5 0.25 2 3\n", "x.alta");
  ASSERT_TRUE(read) << describe(read.error());
  ASSERT_EQ(read->points.size(), 2u);
  EXPECT_EQ(read->points[0].U_per_sr, 0.25);
  EXPECT_EQ(read->points[0].k, 0.0) << "ALTA does not say";
  EXPECT_EQ(read->points[1].f_per_sr, 2.5);
  EXPECT_EQ(read->points[1].U_per_sr, 0.5);
}

TEST(AltaFile, OfOthersIsReadMadeASurfaceAndWritten) {
  const std::optional<std::string> text = file_content(shared_folder() / "data/measured/retro-3m-yellow.alta");
  if (!text) {
    std::cout << "no measured data in " << shared_folder() << ": nothing checked\n";
    return;
  }
  const Result<MeasuredBrdf> read = read_alta(*text, "retro-3m-yellow.alta");

  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->metadata.sample, "3M Yellow");
  ASSERT_GT(read->points.size(), 7000u);
  const BrdfPoint& found = brightest(*read);
  EXPECT_GT(found.f_per_sr, 15.0);
  const Result<SurfaceFile> surfaces = surfaces_of(*read);
  ASSERT_TRUE(surfaces) << describe(surfaces.error());
  // The hot spot is where the light comes from.
  for (const double theta : {15.0, 30.0, 60.0}) {
    const auto i = reflectance::Direction::from_angles(degrees(theta), Angle{});
    EXPECT_GT(in_per_steradian(surfaces->channels[0].surface.eval(i, i)), 7.0) << theta;
  }
  const Result<MeasuredBrdf> again = read_astm(bytes_of(write_astm(*read), ".astm"), "again.astm");
  ASSERT_TRUE(again) << describe(again.error());
  EXPECT_EQ(again->points.size(), read->points.size());
}

TEST(AltaFile, SaysWhereABadOneIsBad) {
  const auto said = [](const std::string& text) {
    const Result<MeasuredBrdf> read = read_alta(text, "bad.alta");
    return read ? std::string("it was read") : describe(read.error());
  };
  const std::string head = "#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n";
  EXPECT_THAT(said(""), HasSubstr("PARAM_IN"));
  EXPECT_THAT(said("0 0 0 1\n"), HasSubstr("PARAM_IN"));
  EXPECT_THAT(said(head), HasSubstr("no points"));
  EXPECT_THAT(said(head + "0 0 0\n"), HasSubstr("bad.alta:3"));
  EXPECT_THAT(said(head + "0 0 0 nan\n"), HasSubstr("finite"));
  EXPECT_THAT(said(head + "1.6 0 0 1\n"), HasSubstr("bad.alta:3"));
  EXPECT_THAT(said("#DIM 99999999999 1\n"), HasSubstr("DIM"));
  EXPECT_THAT(said("#DIM 2 1\n#PARAM_IN RUSIN_TH_TD_PD\n0 0 1\n"), HasSubstr("DIM"));
  EXPECT_THAT(said("#PARAM_IN STARK_2D\n"), HasSubstr("STARK_2D"));
  EXPECT_THAT(said("#PARAM_OUT ENERGY\n"), HasSubstr("ENERGY"));
  EXPECT_THAT(said(head + "#VS 1 1\n0 0 0 1\n"), HasSubstr("VS"));
  EXPECT_THAT(said(head + "#VS 7\n"), HasSubstr("VS"));
  for (const std::string line : {"#PARAM_IN CARTESIAN", "#PARAM_OUT RGB_COLOR", "#DIM 6 3", "#VS 2", "#FORMAT text"}) {
    EXPECT_THAT(said(head + "0 0 0 1\n" + line + "\n0 0 0 1\n"), HasSubstr("bad.alta:4")) << line;
  }
}

TEST(AltaFile, OtherRemarksMayStandBetweenRows) {
  const Result<MeasuredBrdf> read =
      read_alta("#DIM 3 1\n#PARAM_IN RUSIN_TH_TD_PD\n0.1 0.2 0.5 7\n# next ring\n0.1 0.3 0.5 8\n", "x.alta");

  ASSERT_TRUE(read.has_value()) << describe(read.error());
  EXPECT_EQ(read->points.size(), 2U);
}

}  // namespace
}  // namespace gonio::formats
