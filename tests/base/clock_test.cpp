#include "base/clock.h"

#include <gtest/gtest.h>

namespace gonio {
namespace {

using namespace std::chrono_literals;

TEST(ManualClock, StandsUntilItIsTold) {
  ManualClock clock;
  const Instant before = clock.now();

  EXPECT_EQ(clock.now(), before);
  clock.advance(250ms);
  EXPECT_EQ(clock.now() - before, 250ms);
}

TEST(ManualClock, NeverGoesBack) {
  ManualClock clock;
  const Instant start = clock.now();
  clock.advance(1s);

  clock.advance_to(start);

  EXPECT_EQ(clock.now() - start, 1s);
}

TEST(ManualClock, MovesUtcAlong) {
  ManualClock clock;
  EXPECT_EQ(iso8601(clock.utc_now()), "2026-01-01T00:00:00.000Z");
  clock.advance(36h + 1ms);
  EXPECT_EQ(iso8601(clock.utc_now()), "2026-01-02T12:00:00.001Z");
}

TEST(SystemClock, DoesNotGoBack) {
  const SystemClock clock;
  const Instant first = clock.now();
  EXPECT_GE(clock.now(), first);
}

TEST(Seconds, SaturateInsteadOfOverflowing) {
  EXPECT_EQ(seconds(1.5), 1500ms);
  EXPECT_EQ(seconds(-0.25), -250ms);
  EXPECT_EQ(seconds(1e300), Duration::max());
  EXPECT_EQ(seconds(-1e300), Duration::min());
}

}  // namespace
}  // namespace gonio
