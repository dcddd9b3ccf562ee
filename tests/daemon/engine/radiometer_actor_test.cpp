#include "daemon/engine/radiometer_actor.h"

#include <gtest/gtest.h>

#include "daemon/engine/monitor_actor.h"
#include "tests/support/discrete_executor.h"

namespace gonio::daemon {
namespace {

using namespace std::chrono_literals;
using test::DiscreteExecutor;

/// A meter whose reading is there when its samples have been taken; 3 ms each.
class ScriptedRadiometer final : public drivers::Radiometer {
 public:
  explicit ScriptedRadiometer(const Clock& clock) : clock_(clock) {}

  Result<drivers::DetectorIdentity> ensure_open() override { return drivers::DetectorIdentity{"maker", "PM", "SN-1"}; }
  Result<void> apply(const drivers::RadiometerSettings& settings) override {
    applied.push_back(settings);
    return {};
  }
  Result<void> start_zero() override {
    ready_at_ = clock_.now() + 200ms;
    return {};
  }
  Result<bool> is_zeroed(Duration) override { return clock_.now() >= ready_at_ && !never_ends; }
  Result<void> trigger() override {
    started_ = clock_.now();
    ready_at_ = started_ + applied.back().samples * 3ms;
    return {};
  }
  Result<std::optional<drivers::RadiometerReading>> collect(Duration) override {
    if (collect_error) return failure(*std::exchange(collect_error, std::nullopt));
    if (never_ends || clock_.now() < ready_at_) return std::optional<drivers::RadiometerReading>();
    return std::optional(drivers::RadiometerReading{.mean_w = 2.5e-5,
                                                    .standard_error_w = 1e-9,
                                                    .samples = applied.back().samples,
                                                    .range_w = *applied.back().range_w,
                                                    .started = started_,
                                                    .ended = clock_.now()});
  }

  std::vector<drivers::RadiometerSettings> applied;
  std::optional<Error> collect_error;
  bool never_ends = false;

 private:
  const Clock& clock_;
  Instant started_{};
  Instant ready_at_{};
};

PowerMeterConfig meter() {
  return {.serial = "SN-1", .averages = 1, .sample_time = 3ms, .settle = 100ms};
}

TakeFrame take(Ticket ticket, double range_w = 1e-4) {
  return {.ticket = ticket,
          .settings = {.exposure = 30ms},
          .power = PowerSettings{.range_w = range_w, .wavelength = nanometres(568.0)}};
}

class RadiometerActorTest : public testing::Test {
 protected:
  RadiometerActorTest() {
    executor.add("detector", [this](Instant now) { return actor.step(now); });
    executor.add("monitor", [this](Instant now) { return monitor.step(now); });
  }
  void ask(DetectorRequest request) {
    executor.post([this, request](Instant now) { actor.on(request, now); });
  }
  void ask(MonitorRequest request) {
    executor.post([this, request](Instant now) { monitor.on(request, now); });
  }
  void run_for_answers(std::size_t count) {
    const auto all = [&] { return answers.size() + monitor_answers.size() >= count; };
    ASSERT_EQ(executor.run_until(all, 1h), DiscreteExecutor::Outcome::Reached) << executor.describe();
  }
  const FrameAnswer& frame(std::size_t i) { return std::get<FrameAnswer>(answers.at(i)); }

  ManualClock clock;
  const Instant start = clock.now();
  ScriptedRadiometer radiometer{clock};
  ScriptedRadiometer lamp_meter{clock};
  std::vector<RadiometerActor::Answer> answers;
  std::vector<MonitorActor::Answer> monitor_answers;
  RadiometerActor actor{radiometer,
                        {.meter = meter(), .ranges_w = {1e-3, 1e-4}, .samples = 10, .zero_time = 1s},
                        [this](RadiometerActor::Answer answer) { answers.push_back(std::move(answer)); }};
  MonitorActor monitor{lamp_meter,
                       {.meter = meter(), .wavelength = nanometres(600.0), .range_w = 1e-2},
                       [this](MonitorActor::Answer answer) { monitor_answers.push_back(std::move(answer)); }};
  DiscreteExecutor executor{clock};
};

TEST_F(RadiometerActorTest, AnswersWithOnePixelInPartsOfTheRangeAndTheReadingItself) {
  ask(take(7));

  run_for_answers(1);

  ASSERT_TRUE(frame(0).frame) << describe(frame(0).frame.error());
  const FrameSummary& summary = *frame(0).frame;
  EXPECT_EQ(summary.region.n, 1U);
  EXPECT_DOUBLE_EQ(summary.region.mean, 0.25);
  ASSERT_TRUE(summary.power);
  EXPECT_EQ(summary.power->reading.mean_w, 2.5e-5);
  EXPECT_EQ(summary.power->reading.range_w, 1e-4);
  EXPECT_EQ(summary.power->reading.samples, 10);
  EXPECT_GE(summary.power->ended - summary.power->started, 30ms);
  EXPECT_EQ(summary.settings.exposure, 30ms);
}

TEST_F(RadiometerActorTest, AppliesSettingsWhenTheyChangeOnly) {
  ask(take(1));
  ask(take(2));
  ask(take(3, 1e-3));

  run_for_answers(3);

  ASSERT_EQ(radiometer.applied.size(), 2U);
  EXPECT_EQ(radiometer.applied[1].range_w, 1e-3);
}

TEST_F(RadiometerActorTest, ShowsAnOverloadAsASaturatedPixelWithoutAReading) {
  radiometer.collect_error = Error{.code = ErrorCode::Saturated, .device = "detector", .tried = "read"};
  ask(take(1));

  run_for_answers(1);

  ASSERT_TRUE(frame(0).frame);
  EXPECT_EQ(frame(0).frame->region.saturated, 1U);
  EXPECT_FALSE(frame(0).frame->power);
}

TEST_F(RadiometerActorTest, AppliesSettingsAnewAfterAnError) {
  radiometer.collect_error = Error{.code = ErrorCode::Unreachable, .device = "detector", .tried = "read"};
  ask(take(1));
  ask(take(2));

  run_for_answers(2);

  EXPECT_EQ(frame(0).frame.error().code, ErrorCode::Unreachable);
  EXPECT_TRUE(frame(1).frame);
  EXPECT_EQ(radiometer.applied.size(), 2U);
}

TEST_F(RadiometerActorTest, GivesUpAReadingThatDoesNotEnd) {
  radiometer.never_ends = true;
  ask(take(1));

  run_for_answers(1);

  EXPECT_EQ(frame(0).frame.error().code, ErrorCode::TimedOut);
  EXPECT_LE(clock.now() - start, 10s);
}

TEST_F(RadiometerActorTest, AnswersAZeroWhenItHasEnded) {
  ask(ZeroDetector{5});

  run_for_answers(1);

  const auto& answer = std::get<DetectorAnswer>(answers.at(0));
  EXPECT_EQ(answer.ticket, 5U);
  EXPECT_TRUE(answer.detector);
  EXPECT_GE(clock.now() - start, 200ms);
}

TEST_F(RadiometerActorTest, GivesUpAZeroThatDoesNotEnd) {
  radiometer.never_ends = true;
  ask(ZeroDetector{5});

  run_for_answers(1);

  EXPECT_EQ(std::get<DetectorAnswer>(answers.at(0)).detector.error().code, ErrorCode::TimedOut);
}

TEST_F(RadiometerActorTest, AMonitorCoversTheWindowWithSamplesEightAtLeast) {
  ask(TakeMonitor{.ticket = 1, .window = 300ms});
  ask(TakeMonitor{.ticket = 2, .window = 1ms});

  run_for_answers(2);

  const auto& covered = std::get<MonitorAnswer>(monitor_answers.at(0));
  ASSERT_TRUE(covered.reading) << describe(covered.reading.error());
  EXPECT_EQ(covered.reading->reading.samples, 100);
  EXPECT_EQ(covered.reading->reading.wavelength, nanometres(600.0));
  EXPECT_EQ(std::get<MonitorAnswer>(monitor_answers.at(1)).reading->reading.samples, 8);
}

TEST_F(RadiometerActorTest, DetectorAndMonitorReadAtTheSameTime) {
  ask(take(1));
  ask(TakeMonitor{.ticket = 2, .window = 30ms});

  run_for_answers(2);

  EXPECT_LT(clock.now() - start, 50ms) << "one after the other would take 60 ms";
}

}  // namespace
}  // namespace gonio::daemon
