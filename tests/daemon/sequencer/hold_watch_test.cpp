#include "daemon/sequencer/hold_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gonio::daemon {
namespace {

using testing::HasSubstr;

class HoldWatchTest : public testing::Test {
 protected:
  static Instant at(int s) { return Instant(std::chrono::seconds(s)); }
  void look(int s, bool door_open, double monitor = 1.0) {
    drivers::StageState state;
    state.interlock_open = door_open;
    state.monitor = monitor;
    state.source_shutter = stage::ShutterState::Open;
    watch.see_stage(state, at(s));
  }
  static Hold hold(HoldName name, int since_s) { return {.name = name, .owner = "stage", .since = at(since_s)}; }

  HoldRules rules{.lamp = std::chrono::seconds(60),
                  .door = std::chrono::seconds(10),
                  .disk = std::chrono::seconds(5),
                  .disk_least_bytes = 1000,
                  .disk_again_bytes = 1500};
  HoldWatch watch{rules, LampBand{.low = 0.2, .high = 5.0}, false};
};

TEST_F(HoldWatchTest, ADoorStandsWhileItIsOpenAndMayEndWhenItWasClosedForLongEnough) {
  look(0, true);
  EXPECT_EQ(watch.standing(HoldName::Door), "the interlock is open");
  look(5, false);

  EXPECT_FALSE(watch.standing(HoldName::Door));
  EXPECT_FALSE(watch.ends_by_itself(hold(HoldName::Door, 0), at(14)));
  EXPECT_TRUE(watch.ends_by_itself(hold(HoldName::Door, 0), at(15)));
}

TEST_F(HoldWatchTest, ADoorThatOpensAgainBeginsTheCountAnew) {
  look(0, false);
  look(8, true);
  look(9, false);

  EXPECT_FALSE(watch.ends_by_itself(hold(HoldName::Door, 0), at(18)));
  EXPECT_TRUE(watch.ends_by_itself(hold(HoldName::Door, 0), at(19)));
}

TEST_F(HoldWatchTest, NoHoldEndsSoonerAfterItsBeginningThanTheFileAsks) {
  look(0, false);

  EXPECT_FALSE(watch.ends_by_itself(hold(HoldName::Door, 100), at(109)));
  EXPECT_TRUE(watch.ends_by_itself(hold(HoldName::Door, 100), at(110)));
}

TEST_F(HoldWatchTest, WhatIsNotSeenIsNotSeenToBeGone) {
  look(0, false);
  watch.see_stage_failing({.code = ErrorCode::Unreachable, .device = "stage"});

  EXPECT_FALSE(watch.ends_by_itself(hold(HoldName::Door, 0), at(1000)));
}

TEST_F(HoldWatchTest, ALampIsJudgedInItsLightOnly) {
  drivers::StageState dark;
  dark.monitor = 0.0;
  dark.source_shutter = stage::ShutterState::Closed;
  watch.see_stage(dark, at(0));
  EXPECT_FALSE(watch.standing(HoldName::Lamp));

  look(1, false, 0.1);
  EXPECT_THAT(watch.standing(HoldName::Lamp).value_or(""), HasSubstr("lamp monitor 0.1, limits 0.2 to 5"));
}

TEST_F(HoldWatchTest, OperatorsAndRestartsHoldsNeverEndByThemselves) {
  look(0, false);

  EXPECT_FALSE(watch.ends_by_itself(hold(HoldName::Operator, 0), at(100'000)));
  EXPECT_FALSE(watch.ends_by_itself(hold(HoldName::Restart, 0), at(100'000)));
  EXPECT_FALSE(watch.ends_by_itself(hold(HoldName::Device, 0), at(100'000))) << "the file has no device_s";
}

TEST_F(HoldWatchTest, ADiskIsFullBelowOneLimitAndHasRoomFromTheOtherOn) {
  watch.see_disk(1200, at(0));
  EXPECT_FALSE(watch.standing(HoldName::Disk)) << "it was never below the lower one";
  watch.see_disk(999, at(1));
  EXPECT_TRUE(watch.standing(HoldName::Disk));
  watch.see_disk(1499, at(2));
  EXPECT_TRUE(watch.standing(HoldName::Disk));
  watch.see_disk(1500, at(3));
  EXPECT_FALSE(watch.standing(HoldName::Disk));
  EXPECT_TRUE(watch.ends_by_itself(hold(HoldName::Disk, 1), at(8)));
}

}  // namespace
}  // namespace gonio::daemon
