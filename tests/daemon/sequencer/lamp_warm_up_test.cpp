#include "daemon/sequencer/lamp_warm_up.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gonio::daemon {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;

constexpr double kPercentPerMinute = 0.01 / 60.0;

class LampWatchTest : public testing::Test {
 protected:
  static Instant at(double s) { return Instant(gonio::seconds(s)); }
  // A lamp that warms up like 1 - a exp(-t / tau), looked at once a second.
  void warm_up(double from_s, double to_s, double a, double tau_s) {
    for (double t = from_s; t <= to_s; t += 1.0) lamp.see(1.0 - a * std::exp(-t / tau_s), at(t));
  }

  LampWatch lamp{LampWarmUp{.slope_per_s = 0.1 * kPercentPerMinute, .over = minutes(5), .at_most = minutes(60)}};
};

TEST_F(LampWatchTest, IsWarmWhenItsSlopeOverTheTimeAskedForIsBelowTheLimit) {
  // Of 1 - 0.2 exp(-t / 600 s) the slope is 2 %/min exp(-t / 600 s): 0.1 %/min at 1797 s; a line over the five minutes
  // before has that slope 150 s later.
  warm_up(0, 1850, 0.2, 600);
  EXPECT_FALSE(lamp.is_warm(at(1850)));

  warm_up(1851, 2050, 0.2, 600);
  EXPECT_TRUE(lamp.is_warm(at(2050)));
  EXPECT_NEAR(*lamp.slope_per_s(at(2050)) / kPercentPerMinute, 2.0 * std::exp(-(2050.0 - 150.0) / 600.0), 0.01);
}

TEST_F(LampWatchTest, IsNotWarmBeforeItWasSeenForTheWholeTime) {
  for (int t = 0; t <= 295; t += 5) lamp.see(1.0, at(t));
  EXPECT_FALSE(lamp.is_warm(at(299)));
  EXPECT_EQ(lamp.still_to_see(at(299)), std::chrono::seconds(5));

  lamp.see(1.0, at(300));
  EXPECT_TRUE(lamp.is_warm(at(300)));
}

TEST_F(LampWatchTest, ABreakBeginsTheCountAnew) {
  for (int t = 0; t <= 310; ++t) lamp.see(1.0, at(t));
  ASSERT_TRUE(lamp.is_warm(at(310)));

  EXPECT_FALSE(lamp.is_warm(at(400))) << "not seen for a quarter of the time";
  lamp.see(1.0, at(400));
  EXPECT_FALSE(lamp.is_warm(at(400)));
}

TEST_F(LampWatchTest, NoiseThatHidesTheSlopeIsNotTakenForWarmth) {
  // Two per cent up and down, look by look, flat on the mean: 61 looks leave a slope uncertain by 0.02 sqrt(12 / 61) in
  // five minutes, 0.18 %/min.
  for (int t = 0; t <= 300; t += 5) lamp.see(t % 2 == 0 ? 1.02 : 0.98, at(t));

  EXPECT_LT(*lamp.slope_per_s(at(300)), 0.1 * kPercentPerMinute);
  EXPECT_FALSE(lamp.is_warm(at(300)));
}

TEST_F(LampWatchTest, KeepsAFewHundredValuesHoweverOftenItIsLookedAt) {
  for (int k = 0; k < 400'000; ++k) lamp.see(1.0, Instant(milliseconds(k)));
  EXPECT_TRUE(lamp.is_warm(Instant(milliseconds(400'000))));
}

TEST(LampWatchWithoutACriterion, IsAlwaysWarm) {
  const LampWatch lamp(std::nullopt);
  EXPECT_TRUE(lamp.is_warm(Instant{}));
}

}  // namespace
}  // namespace gonio::daemon
