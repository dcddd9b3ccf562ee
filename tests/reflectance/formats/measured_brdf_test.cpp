#include "reflectance/formats/measured_brdf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string_view>

#include "reflectance/formats/loss.h"
#include "tests/reflectance/formats/sample_files.h"

namespace gonio::formats {
namespace {

using reflectance::TableSymmetry;
using testing::HasSubstr;

TEST(MeasuredBrdf, IsCheckedPointByPoint) {
  struct Row {
    double BrdfPoint::*field;
    double value;
    std::string_view name;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Row& row :
       {Row{&BrdfPoint::theta_i_deg, 90.1, "theta_i_deg"}, Row{&BrdfPoint::theta_r_deg, -91.0, "theta_r_deg"},
        Row{&BrdfPoint::phi_r_deg, kNan, "phi_r_deg"}, Row{&BrdfPoint::f_per_sr, kNan, "f_per_sr"},
        Row{&BrdfPoint::U_per_sr, -0.1, "U_per_sr"}, Row{&BrdfPoint::k, -2.0, "k"}}) {
    MeasuredBrdf brdf = bright_retro();
    brdf.points[17].*row.field = row.value;
    const Result<void> checked = check(brdf, "x.csv");
    ASSERT_FALSE(checked) << row.name;
    EXPECT_EQ(checked.error().where->field, row.name);
    EXPECT_THAT(describe(checked.error()), HasSubstr("point 17"));
  }
}

TEST(MeasuredBrdf, WithoutPointsChannelOrFlagIsRefused) {
  MeasuredBrdf brdf = bright_retro();
  brdf.points[3].channel = 1;
  EXPECT_THAT(describe(check(brdf, "x").error()), HasSubstr("channel 1"));

  brdf = bright_retro();
  brdf.points[3].flags = 1;
  EXPECT_THAT(describe(check(brdf, "x").error()), HasSubstr("flags"));

  brdf.points.clear();
  EXPECT_THAT(describe(check(brdf, "x").error()), HasSubstr("no points"));
}

TEST(MeasuredBrdf, TellsItsSymmetryByItsAzimuths) {
  MeasuredBrdf brdf;
  brdf.channels = {{}};
  brdf.points = {{.theta_i_deg = 30, .theta_r_deg = 20, .phi_r_deg = 90}, {.theta_i_deg = 60, .theta_r_deg = -20}};
  EXPECT_EQ(symmetry_of(brdf), TableSymmetry::Isotropic);

  brdf.points.push_back({.theta_i_deg = 30, .theta_r_deg = 20, .phi_r_deg = 270});
  EXPECT_EQ(symmetry_of(brdf), TableSymmetry::Turn);

  brdf.points.push_back({.theta_i_deg = 30, .phi_i_deg = 45, .theta_r_deg = 20});
  EXPECT_EQ(symmetry_of(brdf), TableSymmetry::Anisotropic);

  brdf.metadata.symmetry = TableSymmetry::Isotropic;
  EXPECT_EQ(symmetry_of(brdf), TableSymmetry::Isotropic);
}

TEST(BrdfPoint, ComesIntoPlainRangesWithoutLookingElsewhere) {
  const BrdfPoint arm{.theta_i_deg = -30, .phi_i_deg = 0, .theta_r_deg = -20, .phi_r_deg = 270};
  const BrdfPoint plain = in_plain_ranges(arm);
  EXPECT_EQ(plain.theta_i_deg, 30.0);
  EXPECT_EQ(plain.phi_i_deg, 180.0);
  EXPECT_EQ(plain.theta_r_deg, 20.0);
  EXPECT_EQ(plain.phi_r_deg, 90.0);
  EXPECT_EQ(plain_azimuth_deg(-1e-20), 0.0);
  EXPECT_EQ(plain_azimuth_deg(-90.0), 270.0);
  EXPECT_EQ(plain_azimuth_deg(360.0), 0.0);
}

TEST(Loss, OfEveryKindHasItsOwnName) {
  std::set<std::string_view> names;
  for (int kind = 0; kind <= static_cast<int>(LossKind::Metadata); ++kind)
    names.insert(loss_name(static_cast<LossKind>(kind)));
  EXPECT_EQ(names.size(), 13u);
}

}  // namespace
}  // namespace gonio::formats
