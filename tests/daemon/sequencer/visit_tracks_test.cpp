#include "daemon/sequencer/visit_tracks.h"

#include <gtest/gtest.h>

namespace gonio::daemon {
namespace {

using calibration::Target;
using std::chrono::seconds;

// Two points of either colour; the anchors are 1 and 3.
std::vector<ScanPoint> two_colours() {
  std::vector<ScanPoint> points(4);
  for (std::size_t k = 0; k < points.size(); ++k) {
    points[k].index = static_cast<std::int32_t>(k);
    points[k].wavelength = nanometres(k < 2 ? 450.0 : 650.0);
  }
  return points;
}

TEST(ReferenceTracks, AreVisitedInTurn) {
  ReferenceTracks tracks({1, 3}, {}, two_colours());

  EXPECT_EQ(tracks.last(), std::nullopt);
  EXPECT_EQ(tracks.due().at, 1);
  tracks.at(1).last = Instant(seconds(10));
  EXPECT_EQ(tracks.due().at, 3);
  EXPECT_EQ(tracks.last(), std::nullopt) << "the other colour was not visited yet";
  tracks.at(3).last = Instant(seconds(12));
  EXPECT_EQ(tracks.due().at, 1);
  EXPECT_EQ(tracks.last(), Instant(seconds(10)));
}

TEST(ReferenceTracks, AVisitJudgesItsOwnColourOnly) {
  ReferenceTracks tracks({1, 3}, {}, two_colours());

  tracks.note({0, Target::Sample}, two_colours());
  tracks.note({2, Target::Sample}, two_colours());

  EXPECT_EQ(tracks.at(1).since, (std::vector<ItemKey>{{0, Target::Sample}}));
  EXPECT_EQ(tracks.at(3).since, (std::vector<ItemKey>{{2, Target::Sample}}));
  EXPECT_TRUE(tracks.is_owed());
  tracks.forget({0, Target::Sample});
  tracks.forget({2, Target::Sample});
  EXPECT_FALSE(tracks.is_owed());
}

TEST(ReferenceTracks, AtOnePointJudgeEverythingAndKnowTheStoresLastVisit) {
  const LastVisit stored{.level = VisitLevel{.point = 3, .level = 7.0, .u_relative = 0.001, .drift = {}},
                         .since = {{0, Target::Sample}}};
  ReferenceTracks one({3}, stored, two_colours());
  ReferenceTracks two({1, 3}, stored, two_colours());

  ASSERT_TRUE(one.level());
  EXPECT_EQ(one.at(3).since.size(), 1U);
  EXPECT_FALSE(two.level()) << "it was at the other point";
  EXPECT_TRUE(two.at(3).level);
  EXPECT_EQ(two.at(1).since.size(), 1U);
}

}  // namespace
}  // namespace gonio::daemon
