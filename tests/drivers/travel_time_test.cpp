#include "drivers/motion/travel_time.h"

#include <gtest/gtest.h>

namespace gonio::drivers {
namespace {

using namespace std::chrono_literals;

// 100 at 20 per s and 40 per s^2: 0.5 s up over 5, 90 at full speed in 4.5 s, 0.5 s down over 5.
TEST(TravelTime, OfALongMoveIsATrapezoid) {
  EXPECT_EQ(travel_time(100.0, 20.0, 40.0), 5500ms);
}

// 2.5 at 40 per s^2: half of it in 0.25 s, as 40 / 2 * 0.25^2 = 1.25; the top speed of 10 is below 20.
TEST(TravelTime, OfAShortMoveNeverReachesTheSpeed) {
  EXPECT_EQ(travel_time(2.5, 20.0, 40.0), 500ms);
}

TEST(TravelTime, IsTheSameBackwards) {
  EXPECT_EQ(travel_time(-100.0, 20.0, 40.0), travel_time(100.0, 20.0, 40.0));
}

TEST(TravelTime, OfNoMoveIsZero) {
  EXPECT_EQ(travel_time(0.0, 20.0, 40.0), 0ms);
}

// Where the ramps meet, 10 at 20 per s and 40 per s^2, both forms say 1 s.
TEST(TravelTime, HasNoStepWhereTheSpeedIsJustReached) {
  EXPECT_EQ(travel_time(10.0, 20.0, 40.0), 1s);
  EXPECT_NEAR(in_seconds(travel_time(10.0 - 1e-9, 20.0, 40.0)), 1.0, 1e-9);
}

}  // namespace
}  // namespace gonio::drivers
