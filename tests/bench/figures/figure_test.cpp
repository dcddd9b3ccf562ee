#include "bench/figures/figure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/temporary_folder.h"

namespace gonio::bench {
namespace {

Figure figure(const std::string& name) {
  const std::vector<Figure> all = notes_figures().value();
  for (const Figure& f : all) {
    if (f.name == name) return f;
  }
  ADD_FAILURE() << "there is no " << name;
  return {};
}

LobePoint highest(const std::vector<LobePoint>& points) {
  return *std::max_element(points.begin(), points.end(),
                           [](const LobePoint& a, const LobePoint& b) { return a.value_per_sr < b.value_per_sr; });
}

TEST(NotesFigures, PutTheHotSpotOfWheatWhereTheLightComesFrom) {
  const Figure wheat = figure("notes-figure-8");
  std::vector<LobePoint> points = cut(wheat, wheat.curves.front());
  // Towards the horizon the bowl rises again: what is meant is the peak within reach of an instrument.
  std::erase_if(points, [](const LobePoint& p) { return std::abs(p.theta_r_deg) > 70.0; });

  EXPECT_EQ(highest(points).theta_r_deg, 30.0);
  EXPECT_NEAR(highest(points).value_per_sr, 0.338909735285344, 1e-12);
}

TEST(NotesFigures, PutTheGlitterBeyondTheSpecularDirection) {
  const Figure sea = figure("notes-figure-4-glitter");

  // 0.0457490578 at 37.55 deg; the cut has a point every 0.25 deg.
  const LobePoint peak = highest(cut(sea, sea.curves.front()));
  EXPECT_EQ(peak.theta_r_deg, -37.5);
  EXPECT_NEAR(peak.value_per_sr, 0.0457490578, 1e-6);
}

TEST(NotesFigures, TurnTheSameLobeAllAroundTheNormal) {
  const Figure wheat = figure("notes-figure-8");
  const std::vector<std::vector<LobePoint>> rows = lobe(wheat, wheat.curves.front());

  for (const std::vector<LobePoint>& row : rows) {
    ASSERT_EQ(row.size(), rows.front().size());
    EXPECT_EQ(row.front().value_per_sr, row.back().value_per_sr);
    EXPECT_EQ(highest(row).phi_r_deg, 0.0) << row.front().theta_r_deg;
  }
}

TEST(NotesFigures, ShowALambertianSurfaceAlikeInAllDirectionsAndItsIntensityAsACosine) {
  const Figure lambertian = figure("notes-figure-3");
  for (const LobePoint& p : cut(lambertian, lambertian.curves[0])) EXPECT_NEAR(p.value_per_sr, 0.159154943, 1e-9);
  for (const LobePoint& p : cut(lambertian, lambertian.curves[1])) {
    EXPECT_NEAR(p.value_per_sr, 0.159154943 * std::cos(p.theta_r_deg * 0.017453292519943), 1e-9);
  }
}

TEST(NotesFigures, AreWrittenWithADataFileForEachCurve) {
  const gonio::test::TemporaryFolder folder;
  const std::vector<Figure> all = notes_figures().value();
  for (const Figure& f : all) {
    ASSERT_TRUE(write_figure(f, folder.path()).has_value());
    EXPECT_TRUE(std::filesystem::exists(folder / (f.name + ".gnuplot")));
    for (const Curve& curve : f.curves) {
      std::ifstream data(folder / (f.name + "-" + curve.file + "-cut.dat"));
      EXPECT_EQ(std::count(std::istreambuf_iterator<char>(data), {}, '\n'), std::lround(8.0 * f.most_theta_r_deg) + 1);
    }
  }
}

TEST(NotesFigures, SayWhichFileCannotBeWritten) {
  const Result<void> written = write_figure(figure("notes-figure-8"), "/nowhere/at/all");

  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().code, ErrorCode::StoreFailed);
  EXPECT_NE(written.error().tried.find("/nowhere/at/all"), std::string::npos);
}

}  // namespace
}  // namespace gonio::bench
