#include "drivers/genicam_camera/genicam_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>

namespace gonio::drivers {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

Error camera_error(ErrorCode code) {
  return {.code = code, .device = "detector", .tried = "talk", .seen = "no"};
}

/// A camera of 2 x 2 pixels that takes what it is given and answers each trigger with the next frame, unless told
/// otherwise.
class ScriptedCamera final : public CameraLink {
 public:
  Result<DetectorIdentity> open() override {
    ++opens;
    if (open_error) return failure(*open_error);
    is_open_ = true;
    has_lost_control_ = false;
    kept = {1ms, 20.0};  // what another controller left behind
    return DetectorIdentity{"maker", "model", serial};
  }
  void close() override { is_open_ = is_streaming_ = false; }
  bool is_open() const override { return is_open_; }
  bool has_lost_control() const override { return has_lost_control_; }
  Result<void> set_format(const CameraFormat& format) override {
    format_ = format;
    return {};
  }
  Result<CameraFormat> format() override {
    CameraFormat format = format_;
    format.width = forced_width.value_or(format.width);
    return format;
  }
  Result<void> set_exposure(const ExposureSettings& settings) override {
    ++exposures_written;
    kept = settings;
    return {};
  }
  Result<ExposureSettings> exposure() override {
    ExposureSettings read = kept;
    read.exposure += rounding;
    return read;
  }
  Result<std::optional<double>> temperature_c() override {
    ++temperatures_read;
    if (!has_temperature) return std::optional<double>();
    return std::optional(31.5);
  }
  Result<void> start() override {
    ++starts;
    is_streaming_ = true;
    queue.clear();
    next_id = 1;
    return {};
  }
  void stop() override { is_streaming_ = false; }
  bool is_streaming() const override { return is_streaming_; }
  Result<void> trigger() override {
    ++triggers;
    if (answers_triggers) queue.push_back(frame(next_id++));
    return {};
  }
  Result<std::optional<CameraFrame>> pop(Duration wait) override {
    waits.push_back(wait);
    if (has_lost_control_) return failure(camera_error(ErrorCode::ControlLost));
    if (queue.empty()) return std::optional<CameraFrame>();
    CameraFrame front = std::move(queue.front());
    queue.pop_front();
    return std::optional<CameraFrame>(std::move(front));
  }

  static CameraFrame frame(std::uint64_t id) {
    return {.is_complete = true,
            .trouble = {},
            .width = 2,
            .height = 2,
            .pixels = {1, 2, 3, 4},
            .frame_id = id,
            .camera_time_ns = id * 1000};
  }

  std::string serial = "SN-1";
  std::optional<Error> open_error;
  std::optional<int> forced_width;
  Duration rounding{};
  bool has_temperature = true;
  bool answers_triggers = true;
  bool has_lost_control_ = false;
  std::deque<CameraFrame> queue;
  std::vector<Duration> waits;
  ExposureSettings kept;
  std::uint64_t next_id = 1;
  int opens = 0, starts = 0, triggers = 0, exposures_written = 0, temperatures_read = 0;

 private:
  bool is_open_ = false;
  bool is_streaming_ = false;
  CameraFormat format_;
};

class GenicamCameraTest : public testing::Test {
 protected:
  static GenicamCameraConfig config() {
    return {.serial = "SN-1",
            .format = {.width = 2, .height = 2, .pixel_format = "Mono12", .packet_size_bytes = 1400},
            .settings = {.exposure = 10ms, .gain_db = 0.0}};
  }

  Result<std::optional<Frame>> take() {
    if (auto triggered = camera.trigger(); !triggered) return failure(triggered.error());
    return camera.collect(5ms);
  }

  void expect_failure(const Result<std::optional<Frame>>& taken, ErrorCode code, const std::string& words) {
    ASSERT_FALSE(taken.has_value());
    EXPECT_EQ(taken.error().code, code);
    EXPECT_THAT(describe(taken.error()), HasSubstr(words));
  }

  ScriptedCamera link;
  ManualClock clock;
  GenicamCamera camera{link, config(), clock};
};

TEST_F(GenicamCameraTest, WritesItsSettingsWhenItOpens) {
  const auto who = camera.ensure_open();

  ASSERT_TRUE(who) << describe(who.error());
  EXPECT_EQ(who->serial, "SN-1");
  EXPECT_EQ(link.kept, (ExposureSettings{10ms, 0.0}));
  EXPECT_TRUE(link.is_streaming());
}

TEST_F(GenicamCameraTest, OpensOnce) {
  ASSERT_TRUE(camera.ensure_open());
  ASSERT_TRUE(camera.ensure_open());

  EXPECT_EQ(link.opens, 1);
}

TEST_F(GenicamCameraTest, RefusesACameraWithAnotherSerialNumberAndLetsItGo) {
  link.serial = "SN-2";

  const auto who = camera.ensure_open();

  ASSERT_FALSE(who.has_value());
  EXPECT_EQ(who.error().code, ErrorCode::WrongDevice);
  EXPECT_THAT(who.error().seen, HasSubstr("SN-2"));
  EXPECT_FALSE(link.is_open());
}

TEST_F(GenicamCameraTest, SaysWhichFormatTheCameraDidNotTake) {
  link.forced_width = 640;

  const auto who = camera.ensure_open();

  ASSERT_FALSE(who.has_value());
  EXPECT_EQ(who.error().code, ErrorCode::SettingNotTaken);
  EXPECT_THAT(who.error().tried, HasSubstr("2 x 2 px"));
  EXPECT_THAT(who.error().seen, HasSubstr("640 x 2 px"));
}

TEST_F(GenicamCameraTest, RefusesAPixelFormatOfColours) {
  GenicamCameraConfig coloured = config();
  coloured.format.pixel_format = "BayerRG12";
  GenicamCamera other(link, coloured, clock);

  const auto who = other.ensure_open();

  ASSERT_FALSE(who.has_value());
  EXPECT_EQ(who.error().code, ErrorCode::InvalidInput);
  EXPECT_THAT(who.error().limit, HasSubstr("Mono12Packed"));
}

TEST_F(GenicamCameraTest, KnowsTheBitsOfAPackedFormat) {
  GenicamCameraConfig packed = config();
  packed.format.pixel_format = "Mono10p";
  GenicamCamera other(link, packed, clock);
  ASSERT_TRUE(other.trigger());

  const auto taken = other.collect(5ms);

  ASSERT_TRUE(taken && *taken);
  EXPECT_EQ((*taken)->significant_bits, 10);
}

TEST_F(GenicamCameraTest, SaysWhichExposureTheCameraDidNotTake) {
  ASSERT_TRUE(camera.ensure_open());
  link.rounding = 50us;

  const auto applied = camera.apply({20ms, 0.0});

  ASSERT_FALSE(applied.has_value());
  EXPECT_EQ(applied.error().code, ErrorCode::SettingNotTaken);
  EXPECT_THAT(applied.error().tried, HasSubstr("0.020000 s"));
  EXPECT_THAT(applied.error().seen, HasSubstr("0.020050 s"));
}

TEST_F(GenicamCameraTest, ReportsTheExposureThatTheCameraRoundedTo) {
  link.rounding = 10us;  // within 0.1 % of 20 ms
  ASSERT_TRUE(camera.apply({20ms, 0.0}));

  const auto taken = take();

  ASSERT_TRUE(taken && *taken);
  EXPECT_EQ((*taken)->settings.exposure, 20010us);
}

TEST_F(GenicamCameraTest, WritesTheSameSettingsOnlyOnce) {
  ASSERT_TRUE(camera.apply({20ms, 0.0}));
  const int written = link.exposures_written;

  ASSERT_TRUE(camera.apply({20ms, 0.0}));

  EXPECT_EQ(link.exposures_written, written);
}

TEST_F(GenicamCameraTest, HandsOutTheFrameOfATrigger) {
  const auto taken = take();

  ASSERT_TRUE(taken) << describe(taken.error());
  ASSERT_TRUE(taken->has_value());
  const Frame& frame = **taken;
  EXPECT_EQ(frame.width, 2);
  EXPECT_EQ(frame.height, 2);
  EXPECT_EQ(frame.pixels, (std::vector<std::uint16_t>{1, 2, 3, 4}));
  EXPECT_EQ(frame.significant_bits, 12);
  EXPECT_EQ(frame.frame_id, 1U);
  EXPECT_EQ(frame.camera_time_ns, 1000U);
  EXPECT_EQ(frame.temperature_c, 31.5);
  EXPECT_EQ(frame.arrived, clock.now());
}

TEST_F(GenicamCameraTest, HandsOutEachFrameOnce) {
  ASSERT_TRUE(take());

  expect_failure(camera.collect(5ms), ErrorCode::WrongState, "none was triggered");
}

TEST_F(GenicamCameraTest, HasNothingYetBeforeTheDeadline) {
  link.answers_triggers = false;
  ASSERT_TRUE(camera.trigger());

  const auto taken = camera.collect(5ms);

  ASSERT_TRUE(taken);
  EXPECT_FALSE(taken->has_value());
}

TEST_F(GenicamCameraTest, DropsFramesThatWereThereBeforeTheTrigger) {
  ASSERT_TRUE(camera.ensure_open());
  link.queue.push_back(ScriptedCamera::frame(1));
  link.next_id = 2;

  const auto taken = take();

  ASSERT_TRUE(taken && *taken);
  EXPECT_EQ((*taken)->frame_id, 2U);
}

TEST_F(GenicamCameraTest, RefusesAFrameThatIsNotTheNext) {
  ASSERT_TRUE(take());
  link.next_id = 3;

  expect_failure(take(), ErrorCode::StaleData, "frame 3");
}

TEST_F(GenicamCameraTest, RefusesTheFrameBeforeOnceMore) {
  ASSERT_TRUE(take());
  link.next_id = 1;

  expect_failure(take(), ErrorCode::StaleData, "the one after 1");
}

TEST_F(GenicamCameraTest, TakesTheFirstFrameOfANewStreamAfterAStaleOne) {
  ASSERT_TRUE(take());
  link.next_id = 3;
  ASSERT_FALSE(take());

  const auto taken = take();

  ASSERT_TRUE(taken && *taken) << "the stream was to be made anew";
  EXPECT_EQ(link.starts, 2);
}

TEST_F(GenicamCameraTest, FollowsIdsOf16BitsAcrossTheirEnd) {
  ASSERT_TRUE(camera.ensure_open());
  link.next_id = 65535;
  ASSERT_TRUE(take());
  link.next_id = 1;

  const auto taken = take();

  ASSERT_TRUE(taken && *taken);
}

TEST_F(GenicamCameraTest, RefusesAnIncompleteFrameAndGoesOn) {
  link.answers_triggers = false;
  ASSERT_TRUE(camera.trigger());
  link.queue.push_back({.is_complete = false, .trouble = "packets missing", .frame_id = 1});
  expect_failure(camera.collect(5ms), ErrorCode::IncompleteData, "packets missing");
  link.answers_triggers = true;
  link.next_id = 2;

  const auto taken = take();

  ASSERT_TRUE(taken && *taken);
  EXPECT_EQ(link.starts, 1);
}

TEST_F(GenicamCameraTest, RefusesAFrameOfAnotherSize) {
  link.answers_triggers = false;
  ASSERT_TRUE(camera.trigger());
  CameraFrame odd = ScriptedCamera::frame(1);
  odd.width = 4;
  link.queue.push_back(odd);

  expect_failure(camera.collect(5ms), ErrorCode::IncompleteData, "4 x 2 px");
}

TEST_F(GenicamCameraTest, TimesOutByTheExposureAndNotBefore) {
  link.answers_triggers = false;
  ASSERT_TRUE(camera.trigger());
  clock.advance(10ms + 999ms);
  const auto before = camera.collect(5ms);
  clock.advance(1ms);

  const auto after = camera.collect(5ms);

  EXPECT_TRUE(before.has_value());
  expect_failure(after, ErrorCode::TimedOut, "1.010 s after the trigger");
}

TEST_F(GenicamCameraTest, MakesTheStreamAnewAfterAFrameThatNeverCame) {
  link.answers_triggers = false;
  ASSERT_TRUE(camera.trigger());
  clock.advance(2s);
  ASSERT_FALSE(camera.collect(5ms));
  link.answers_triggers = true;

  const auto taken = take();

  ASSERT_TRUE(taken && *taken);
  EXPECT_EQ(link.starts, 2);
}

TEST_F(GenicamCameraTest, NeverWaitsPastItsDeadline) {
  link.answers_triggers = false;
  ASSERT_TRUE(camera.trigger());
  clock.advance(1s);

  ASSERT_TRUE(camera.collect(5s));

  EXPECT_EQ(link.waits.back(), 10ms);
}

TEST_F(GenicamCameraTest, WritesEverythingAgainAfterControlWasLost) {
  ASSERT_TRUE(camera.apply({20ms, 6.0}));
  link.has_lost_control_ = true;

  const auto taken = take();

  ASSERT_TRUE(taken && *taken);
  EXPECT_EQ(link.opens, 2);
  EXPECT_EQ(link.kept, (ExposureSettings{20ms, 6.0}));
}

TEST_F(GenicamCameraTest, ReportsControlLostWhileAFrameIsAwaited) {
  link.answers_triggers = false;
  ASSERT_TRUE(camera.trigger());
  link.has_lost_control_ = true;

  expect_failure(camera.collect(5ms), ErrorCode::ControlLost, "detector");
}

TEST_F(GenicamCameraTest, PassesOnThatAnotherControllerHoldsTheCamera) {
  link.open_error = camera_error(ErrorCode::ControlLost);

  expect_failure(take(), ErrorCode::ControlLost, "detector");
}

TEST_F(GenicamCameraTest, IsOpenedAgainAfterItWasUnreachable) {
  link.open_error = camera_error(ErrorCode::Unreachable);
  ASSERT_FALSE(camera.ensure_open());
  link.open_error.reset();

  EXPECT_TRUE(camera.ensure_open().has_value());
}

TEST_F(GenicamCameraTest, GivesUpOnACameraThatNeverStopsSending) {
  ASSERT_TRUE(camera.ensure_open());
  for (std::uint64_t id = 1; id <= 100; ++id) link.queue.push_back(ScriptedCamera::frame(id));

  const auto triggered = camera.trigger();

  ASSERT_FALSE(triggered.has_value());
  EXPECT_EQ(triggered.error().code, ErrorCode::StaleData);
  EXPECT_EQ(link.triggers, 0);
}

TEST_F(GenicamCameraTest, ReadsTheTemperatureOnceASecond) {
  ASSERT_TRUE(take());
  ASSERT_TRUE(take());
  EXPECT_EQ(link.temperatures_read, 1);

  clock.advance(1s);
  ASSERT_TRUE(take());

  EXPECT_EQ(link.temperatures_read, 2);
}

TEST_F(GenicamCameraTest, WorksWithoutATemperature) {
  link.has_temperature = false;

  const auto taken = take();

  ASSERT_TRUE(taken && *taken);
  EXPECT_EQ((*taken)->temperature_c, std::nullopt);
}

}  // namespace
}  // namespace gonio::drivers
