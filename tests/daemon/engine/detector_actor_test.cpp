#include "daemon/engine/detector_actor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/discrete_executor.h"

namespace gonio::daemon {
namespace {

using namespace std::chrono_literals;
using test::DiscreteExecutor;

Error detector_error(ErrorCode code) {
  return {.code = code, .device = "detector", .tried = "talk", .seen = "no"};
}

/// A detector of 3 x 3 pixels; its frame is there when the exposure is over.
class ScriptedDetector final : public drivers::Detector {
 public:
  explicit ScriptedDetector(const Clock& clock) : clock_(clock) {}

  Result<drivers::DetectorIdentity> ensure_open() override {
    if (open_error) return failure(*open_error);
    return drivers::DetectorIdentity{"maker", "model", "SN-1"};
  }
  Result<void> apply(const drivers::ExposureSettings& settings) override {
    if (apply_error) return failure(*apply_error);
    applied.push_back(settings);
    return {};
  }
  Result<void> trigger() override {
    ready_at_ = clock_.now() + applied.back().exposure + readout;
    return {};
  }
  Result<std::optional<drivers::Frame>> collect(Duration) override {
    ++looks;
    if (collect_error) return failure(*collect_error);
    if (clock_.now() < ready_at_) return std::optional<drivers::Frame>();
    return std::optional<drivers::Frame>(drivers::Frame{.width = 3,
                                                        .height = 3,
                                                        .significant_bits = 12,
                                                        .pixels = pixels,
                                                        .frame_id = 17,
                                                        .camera_time_ns = 99,
                                                        .settings = applied.back(),
                                                        .temperature_c = 30.5});
  }

  std::optional<Error> open_error, apply_error, collect_error;
  std::vector<drivers::ExposureSettings> applied;
  std::vector<std::uint16_t> pixels = std::vector<std::uint16_t>(9, 100);
  Duration readout = 5ms;
  int looks = 0;

 private:
  const Clock& clock_;
  Instant ready_at_{};
};

class DetectorActorTest : public testing::Test {
 protected:
  DetectorActorTest() {
    executor.add("detector", [this](Instant now) { return actor.step(now); });
  }

  void ask(DetectorRequest request) {
    executor.post([this, request](Instant now) { actor.on(request, now); });
  }

  void run_for_answers(std::size_t count) {
    ASSERT_EQ(executor.run_until([&] { return answers.size() >= count; }, 1h), DiscreteExecutor::Outcome::Reached)
        << executor.describe();
  }

  const FrameAnswer& frame(std::size_t i) { return std::get<FrameAnswer>(answers.at(i)); }

  void expect_failure(std::size_t i, ErrorCode code) {
    ASSERT_FALSE(frame(i).frame.has_value());
    EXPECT_EQ(frame(i).frame.error().code, code);
  }

  ManualClock clock;
  ScriptedDetector detector{clock};
  std::vector<DetectorActor::Answer> answers;
  DetectorActor actor{detector,
                      {.aperture = {.centre_x_px = 1.0, .centre_y_px = 1.0, .radius_px = 1.2}},
                      [this](DetectorActor::Answer answer) { answers.push_back(std::move(answer)); }};
  DiscreteExecutor executor{clock};
};

TEST_F(DetectorActorTest, AnswersWithTheStatisticsOfTheMask) {
  detector.pixels = {9, 104, 9, 100, 102, 100, 9, 104, 9};  // the mask is the cross: 104, 100, 102, 100, 104
  const Instant start = clock.now();
  ask(TakeFrame{7, {200ms, 3.0}});

  run_for_answers(1);

  EXPECT_EQ(frame(0).ticket, 7U);
  ASSERT_TRUE(frame(0).frame) << describe(frame(0).frame.error());
  const FrameSummary& summary = *frame(0).frame;
  EXPECT_EQ(summary.region.n, 5U);
  EXPECT_DOUBLE_EQ(summary.region.mean, 102.0);
  EXPECT_NEAR(summary.region.m2, 3.2, 1e-12);  // (4 + 4 + 0 + 4 + 4) / 5
  EXPECT_EQ(summary.settings, (drivers::ExposureSettings{200ms, 3.0}));
  EXPECT_EQ(summary.frame_id, 17U);
  EXPECT_EQ(summary.camera_time_ns, 99U);
  EXPECT_EQ(summary.temperature_c, 30.5);
  EXPECT_GE(clock.now() - start, 205ms);
  EXPECT_LE(clock.now() - start, 207ms);
}

TEST_F(DetectorActorTest, AddsFramesToTheSumsThatAreAskedForBeforeItAnswers) {
  detector.pixels = {9, 104, 9, 100, 102, 100, 9, 104, 9};
  const auto sums = std::make_shared<calibration::PixelSums>();
  ask(TakeFrame{.ticket = 7, .settings = {200ms, 3.0}, .sums = sums});
  run_for_answers(1);
  ask(TakeFrame{.ticket = 8, .settings = {200ms, 3.0}});
  run_for_answers(2);

  EXPECT_EQ(sums->frames, 1) << "the second frame is nobody's";
  EXPECT_EQ(sums->exposure, 200ms);
  EXPECT_EQ(sums->sum, (std::vector<double>{9, 104, 9, 100, 102, 100, 9, 104, 9}));
}

TEST_F(DetectorActorTest, AFrameThatDoesNotFitItsSumsIsAnError) {
  const auto sums = std::make_shared<calibration::PixelSums>();
  ask(TakeFrame{.ticket = 7, .settings = {200ms, 3.0}, .sums = sums});
  run_for_answers(1);
  ask(TakeFrame{.ticket = 8, .settings = {100ms, 3.0}, .sums = sums});
  run_for_answers(2);

  expect_failure(1, ErrorCode::IncompleteData);
  EXPECT_EQ(sums->frames, 1);
}

TEST_F(DetectorActorTest, DoesNotLookBeforeTheExposureIsOver) {
  ask(TakeFrame{7, {10s, 0.0}});
  executor.run_for(9999ms);

  EXPECT_EQ(detector.looks, 0);
}

TEST_F(DetectorActorTest, CountsPixelsAtTheFullScaleOfTheFormatAsSaturated) {
  detector.pixels[4] = 4095;
  ask(TakeFrame{1, {1ms, 0.0}});

  run_for_answers(1);

  ASSERT_TRUE(frame(0).frame);
  EXPECT_EQ(frame(0).frame->region.saturated, 1U);
}

TEST_F(DetectorActorTest, TakesFramesOneAfterTheOther) {
  ask(TakeFrame{1, {100ms, 0.0}});
  ask(TakeFrame{2, {50ms, 0.0}});

  run_for_answers(2);

  EXPECT_EQ(frame(0).ticket, 1U);
  EXPECT_EQ(frame(1).ticket, 2U);
}

TEST_F(DetectorActorTest, TellsThatASettingWasNotTaken) {
  detector.apply_error = detector_error(ErrorCode::SettingNotTaken);
  ask(TakeFrame{1, {1ms, 0.0}});

  run_for_answers(1);

  expect_failure(0, ErrorCode::SettingNotTaken);
}

TEST_F(DetectorActorTest, TellsThatAFrameWasIncompleteAndTakesTheNext) {
  detector.collect_error = detector_error(ErrorCode::IncompleteData);
  ask(TakeFrame{1, {1ms, 0.0}});
  run_for_answers(1);
  detector.collect_error.reset();

  ask(TakeFrame{2, {1ms, 0.0}});
  run_for_answers(2);

  expect_failure(0, ErrorCode::IncompleteData);
  EXPECT_TRUE(frame(1).frame.has_value());
}

TEST_F(DetectorActorTest, TellsThatAFrameDoesNotHoldTheMask) {
  detector.pixels.resize(8);
  ask(TakeFrame{1, {1ms, 0.0}});

  run_for_answers(1);

  expect_failure(0, ErrorCode::IncompleteData);
}

TEST_F(DetectorActorTest, PreparesTheDetector) {
  ask(PrepareDetector{4});

  run_for_answers(1);

  const auto& answer = std::get<DetectorAnswer>(answers[0]);
  EXPECT_EQ(answer.ticket, 4U);
  ASSERT_TRUE(answer.detector);
  EXPECT_EQ(answer.detector->serial, "SN-1");
}

TEST_F(DetectorActorTest, SaysBusyToOneRequestTooMany) {
  ask(TakeFrame{1, {1s, 0.0}});
  for (Ticket ticket = 2; ticket <= 2 + DetectorActor::kMostWaiting; ++ticket) ask(TakeFrame{ticket, {1s, 0.0}});

  executor.run_for(10ms);

  ASSERT_EQ(answers.size(), 1U);
  expect_failure(0, ErrorCode::Busy);
}

}  // namespace
}  // namespace gonio::daemon
