#include "daemon/engine/halt_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace gonio::daemon {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

Error line_error() {
  return {.code = ErrorCode::Unreachable, .device = "stage", .tried = "talk", .seen = "no"};
}

/// A line that notes what goes over it, and can be made to fail or to hang. Threads: any.
class ScriptedHaltLine final : public drivers::HaltLine {
 public:
  Result<void> halt(drivers::Epoch epoch) override {
    std::unique_lock lock(mutex_);
    halts_.push_back(epoch);
    changed_.notify_all();
    changed_.wait(lock, [&] { return !halt_hangs_; });
    return outcome(failing_halts_);
  }
  Result<void> watch_heartbeat(Duration timeout) override {
    const std::lock_guard lock(mutex_);
    armed_ = timeout;
    return outcome(failing_beats_);
  }
  Result<void> beat() override {
    std::unique_lock lock(mutex_);
    ++beats_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return !beat_hangs_ || interrupted_; });
    return interrupted_ ? Result<void>(failure(line_error())) : Result<void>();
  }
  void interrupt() override {
    const std::lock_guard lock(mutex_);
    interrupted_ = true;
    changed_.notify_all();
  }

  void wait_for_halts(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return halts_.size() >= count; });
  }
  void wait_for_beats(int count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return beats_ >= count; });
  }
  void fail(int halts, int beats) {
    const std::lock_guard lock(mutex_);
    failing_halts_ = halts;
    failing_beats_ = beats;
  }
  void hang(bool halt, bool beat) {
    const std::lock_guard lock(mutex_);
    halt_hangs_ = halt;
    beat_hangs_ = beat;
    changed_.notify_all();
  }
  std::vector<drivers::Epoch> halts() {
    const std::lock_guard lock(mutex_);
    return halts_;
  }
  int beats() {
    const std::lock_guard lock(mutex_);
    return beats_;
  }
  Duration armed() {
    const std::lock_guard lock(mutex_);
    return armed_;
  }

 private:
  static Result<void> outcome(int& failing) {
    if (failing == 0) return {};
    --failing;
    return failure(line_error());
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<drivers::Epoch> halts_;
  int beats_ = 0;
  Duration armed_{};
  int failing_halts_ = 0;
  int failing_beats_ = 0;
  bool halt_hangs_ = false;
  bool beat_hangs_ = false;
  bool interrupted_ = false;
};

/// Keeps what was reported. Threads: any.
class Reports {
 public:
  void add(const HaltPathReport& report) {
    const std::lock_guard lock(mutex_);
    if (const auto* halt = std::get_if<HaltReport>(&report)) halts_.push_back(*halt);
    if (const auto* line = std::get_if<HaltLineReport>(&report)) lines_.push_back(line->is_up);
    changed_.notify_all();
  }
  std::vector<HaltReport> wait_for_halts(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return halts_.size() >= count; });
    return halts_;
  }
  std::vector<bool> wait_for_lines(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return lines_.size() >= count; });
    return lines_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<HaltReport> halts_;
  std::vector<bool> lines_;
};

class HaltPathTest : public testing::Test {
 protected:
  std::unique_ptr<HaltPath> open(Duration heartbeat_timeout, drivers::Epoch first = 0) {
    return std::make_unique<HaltPath>(
        line, clock, HaltPathConfig{.heartbeat_timeout = heartbeat_timeout, .first_epoch = first, .retry = 1ms},
        [this](const HaltPathReport& report) { reports.add(report); });
  }

  SystemClock clock;
  ScriptedHaltLine line;
  Reports reports;
};

TEST_F(HaltPathTest, HaltsWithTheRaisedEpoch) {
  const auto path = open(1h, 7);

  const drivers::Epoch raised = path->stop("uid:1000");

  EXPECT_EQ(raised, 8U);
  EXPECT_EQ(path->epoch(), 8U);
  const auto halts = reports.wait_for_halts(1);
  EXPECT_EQ(halts[0].epoch, 8U);
  EXPECT_EQ(halts[0].who, "uid:1000");
  EXPECT_TRUE(halts[0].outcome.has_value());
  EXPECT_THAT(line.halts(), ElementsAre(8U));
}

TEST_F(HaltPathTest, OpensItsLineAndArmsTheWatchAtOnce) {
  const auto path = open(2s);

  EXPECT_THAT(reports.wait_for_lines(1), ElementsAre(true));
  EXPECT_EQ(line.armed(), 2s);
  EXPECT_EQ(line.beats(), 1);
}

TEST_F(HaltPathTest, DoesNotWaitForABeatThatGetsNoReply) {
  line.hang(false, true);
  const auto path = open(1h);
  line.wait_for_beats(1);

  path->stop("operator");

  EXPECT_TRUE(reports.wait_for_halts(1)[0].outcome.has_value());
}

TEST_F(HaltPathTest, FeedsTheHeartbeatWhileTheEngineRenewsIt) {
  const auto path = open(4ms);

  for (int beat = 1; beat <= 5; ++beat) {
    line.wait_for_beats(beat);
    path->renew();
  }

  line.wait_for_beats(6);
}

TEST_F(HaltPathTest, StopsFeedingWhenTheEngineIsStuck) {
  const auto path = open(4ms);
  line.wait_for_beats(1);
  path->renew();
  line.wait_for_beats(2);

  path->stop("operator");  // something that happens later on the same thread
  reports.wait_for_halts(1);

  EXPECT_EQ(line.beats(), 2);
}

TEST_F(HaltPathTest, TriesAHaltUntilItIsDeliveredAndReportsTheFirstFailure) {
  line.fail(3, 0);
  const auto path = open(1h);

  path->stop("operator");

  const auto halts = reports.wait_for_halts(2);
  ASSERT_EQ(halts.size(), 2U);
  EXPECT_FALSE(halts[0].outcome.has_value());
  EXPECT_TRUE(halts[1].outcome.has_value());
  EXPECT_THAT(line.halts(), ElementsAre(1U, 1U, 1U, 1U));
}

TEST_F(HaltPathTest, HaltsOnceMoreWithTheHighestEpochWhenStopsCameMeanwhile) {
  line.hang(true, false);
  const auto path = open(1h);
  path->stop("one");
  line.wait_for_halts(1);

  path->stop("two");
  const drivers::Epoch last = path->stop("three");
  line.hang(false, false);

  line.wait_for_halts(2);
  const auto halts = reports.wait_for_halts(2);
  EXPECT_THAT(line.halts(), ElementsAre(1U, last));
  EXPECT_EQ(halts.back().epoch, 3U);
}

TEST_F(HaltPathTest, TakesOverAHigherEpochAndNoLowerOne) {
  const auto path = open(1h, 5);

  path->adopt(9);
  path->adopt(3);

  EXPECT_EQ(path->epoch(), 9U);
  EXPECT_EQ(path->stop("operator"), 10U);
}

TEST_F(HaltPathTest, ReportsOnceThatItsLineIsDownAndOnceThatItIsBack) {
  line.fail(0, 3);
  const auto path = open(4ms);
  std::thread engine([&] {
    for (int i = 0; line.beats() < 1; ++i) {
      path->renew();
      std::this_thread::yield();
    }
  });

  const auto lines = reports.wait_for_lines(2);

  engine.join();
  EXPECT_THAT(lines, ElementsAre(false, true));
}

TEST_F(HaltPathTest, DeliversAHaltThatWasAskedForJustBeforeTheEnd) {
  line.hang(true, false);
  auto path = open(1h);
  path->stop("one");
  line.wait_for_halts(1);
  path->stop("two");
  line.hang(false, false);

  path.reset();

  EXPECT_EQ(line.halts().back(), 2U);
}

}  // namespace
}  // namespace gonio::daemon
