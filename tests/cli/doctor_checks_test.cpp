#include "cli/doctor/checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "cli/doctor/trial_move.h"
#include "cli/doctor/trial_reading.h"

namespace gonio::cli {
namespace {

using testing::HasSubstr;

const api::AxisLimits kAxis{.name = "theta_r",
                            .unit = "deg",
                            .low = 0.0,
                            .high = 85.0,
                            .speed_per_s = 20.0,
                            .acceleration_per_s2 = 40.0,
                            .settle_s = 0.1,
                            .window = 0.01};

api::StageReport good_stage() {
  return {.homed = true,
          .monitor = 1.0,
          .lamp_temperature_c = 45.0,
          .detector_temperature_c = 25.0,
          .room_temperature_c = 22.0,
          .humidity_percent = 40.0};
}

Verdict worst(const std::vector<Finding>& findings) {
  Verdict worst = Verdict::Ok;
  for (const Finding& f : findings) {
    if (f.verdict == Verdict::Failed || worst == Verdict::Ok) worst = f.verdict;
    if (worst == Verdict::Failed) break;
  }
  return worst;
}

TEST(DoctorChecks, OfAGoodInstrumentAreAllOk) {
  api::StatusReport status{.version = "0.1.0", .stage = good_stage()};
  const api::InstrumentReport instrument{
      .axes = {kAxis}, .monitor_low = 0.2, .monitor_high = 5.0, .store_free_bytes = 1'000'000'000'000};
  const api::ReferenceList references{{{.serial = "SRT-1", .certificate_date = "2026-01-01", .expires = "2028-01-01"}}};

  EXPECT_EQ(worst(check_daemon(status, "0.1.0")), Verdict::Ok);
  EXPECT_EQ(worst(check_stage(good_stage(), instrument)), Verdict::Ok);
  EXPECT_EQ(worst(check_instrument(instrument)), Verdict::Ok);
  EXPECT_EQ(worst(check_references(references, "2026-11-22")), Verdict::Ok);
}

TEST(DoctorChecks, NameWhatKeepsTheStageFromMovingAndTheWayOut) {
  const api::InstrumentReport instrument{.monitor_low = 0.2, .monitor_high = 5.0};
  api::StageReport stopped = good_stage();
  stopped.halted = true;
  api::StageReport open = good_stage();
  open.interlock_open = true;
  api::StageReport lost = good_stage();
  lost.homed = false;

  EXPECT_THAT(check_stage(stopped, instrument)[0].remedy, HasSubstr("gonioctl stage reset"));
  EXPECT_THAT(check_stage(open, instrument)[0].seen, HasSubstr("interlock"));
  EXPECT_EQ(check_stage(lost, instrument)[1].verdict, Verdict::Warning);
  EXPECT_THAT(check_stage(lost, instrument)[1].remedy, HasSubstr("gonioctl stage home"));
}

TEST(DoctorChecks, ALampOutOfItsBandFailsAndASensorThatReadsNothingIsDoubted) {
  const api::InstrumentReport instrument{.monitor_low = 0.2, .monitor_high = 5.0};
  api::StageReport dark = good_stage();
  dark.monitor = 0.01;
  dark.room_temperature_c = 0.0;

  const std::vector<Finding> findings = check_stage(dark, instrument);

  EXPECT_EQ(findings[2].verdict, Verdict::Failed);
  EXPECT_EQ(findings[2].limit, "0.2 to 5");
  EXPECT_EQ(findings[5].verdict, Verdict::Warning);
}

TEST(DoctorChecks, AStageThatHasNotAnsweredForLongIsNoStage) {
  api::StatusReport silent{.version = "0.1.0", .stage = good_stage()};
  silent.stage->age_s = 12.0;
  api::StatusReport never{.version = "0.1.0"};

  EXPECT_EQ(worst(check_daemon(silent, "0.1.0")), Verdict::Failed);
  EXPECT_EQ(worst(check_daemon(never, "0.1.0")), Verdict::Failed);
  EXPECT_EQ(check_daemon(silent, "0.2.0")[0].verdict, Verdict::Warning) << "another version";
}

TEST(DoctorChecks, CertificatesAreCountedInDays) {
  const auto verdict_on = [](const std::string& today) {
    return check_references({{{.serial = "S", .certificate_date = "2024-03-01", .expires = "2026-03-01"}}}, today)[0];
  };

  EXPECT_EQ(verdict_on("2025-12-30").verdict, Verdict::Ok) << "61 days";
  EXPECT_EQ(verdict_on("2026-02-27").verdict, Verdict::Warning);
  EXPECT_THAT(verdict_on("2026-02-27").seen, HasSubstr(": 2 days left"));
  EXPECT_EQ(verdict_on("2026-03-01").verdict, Verdict::Warning) << "the last day";
  EXPECT_EQ(verdict_on("2026-03-02").verdict, Verdict::Failed);
  EXPECT_EQ(check_references({}, "2026-03-02")[0].verdict, Verdict::Failed);
}

TEST(DoctorChecks, ADiskThatFillsUpIsSaidBeforeItIsFull) {
  constexpr std::int64_t kGibibyte = 1LL << 30;
  EXPECT_EQ(check_instrument({.store_free_bytes = 10 * kGibibyte})[0].verdict, Verdict::Ok);
  EXPECT_EQ(check_instrument({.store_free_bytes = 3 * kGibibyte})[0].verdict, Verdict::Warning);
  EXPECT_EQ(check_instrument({.store_free_bytes = kGibibyte / 2})[0].verdict, Verdict::Failed);
}

// By hand: 20 deg/s with 40 deg/s^2 takes both ramps together 10 deg; 8.5 deg: 2 sqrt(8.5 / 40) = 0.922 s, and 0.1 s.
// 30 deg: 30 / 20 + 20 / 40 + 0.1 = 2.1 s.
TEST(DoctorChecks, TheTimeOfAWayIsThatOfATrapezoid) {
  EXPECT_NEAR(told_time_s(kAxis, -8.5), 1.0220, 5e-5);
  EXPECT_NEAR(told_time_s(kAxis, 30.0), 2.1, 1e-12);
}

TEST(DoctorChecks, ATrialGoesTowardsTheLongerSideAndStaysInside) {
  EXPECT_DOUBLE_EQ(trial_target(kAxis, 0.0), 8.5);
  EXPECT_DOUBLE_EQ(trial_target(kAxis, 80.0), 71.5);
  EXPECT_DOUBLE_EQ(trial_target({.unit = "slot", .low = 1.0, .high = 4.0}, 1.0), 2.0);
}

TEST(DoctorChecks, AnAxisIsJudgedByWhereItStandsAndByItsTime) {
  EXPECT_EQ(check_axis_move(kAxis, 0.0, 8.5, 8.505, 1.1).verdict, Verdict::Ok);
  EXPECT_EQ(check_axis_move(kAxis, 0.0, 8.5, -8.5, 1.1).verdict, Verdict::Failed) << "the wrong way";
  EXPECT_EQ(check_axis_move(kAxis, 0.0, 8.5, 8.5, 3.0).verdict, Verdict::Warning) << "slower than told";
  EXPECT_EQ(check_axis_move(kAxis, 0.0, 85.0, 85.0, 1.0).verdict, Verdict::Warning) << "faster than told";
}

TEST(DoctorChecks, AStopMustEndTheMoveAsStopped) {
  const Error stopped{.code = ErrorCode::Stopped};
  const Error late{.code = ErrorCode::TimedOut};

  EXPECT_EQ(check_stop("phi_r", 180.0, 40.0, 0.02, stopped).verdict, Verdict::Ok);
  EXPECT_EQ(check_stop("phi_r", 180.0, 40.0, 0.6, stopped).verdict, Verdict::Warning);
  EXPECT_EQ(check_stop("phi_r", 180.0, 40.0, 0.02, late).verdict, Verdict::Failed);
  EXPECT_EQ(check_stop("phi_r", 180.0, 180.0, 0.02, std::nullopt).verdict, Verdict::Failed) << "a move that counted";
}

TEST(DoctorChecks, TakeADarkForOneOnlyBelowHalfOfFullScaleAndAboveNought) {
  const api::DetectorReading good{.unit = "DN", .value = 70.0, .noise = 3.0, .values = 448, .full_scale = 4095.0};
  api::DetectorReading bright = good;
  bright.value = 2500.0;
  api::DetectorReading clipped = good;
  clipped.value = 0.0;

  EXPECT_EQ(check_dark_reading(good).verdict, Verdict::Ok);
  EXPECT_EQ(check_dark_reading(bright).verdict, Verdict::Failed);
  EXPECT_EQ(check_dark_reading(clipped).verdict, Verdict::Warning);
}

// 3 DN of noise in 448 pixels: each mean is good to 0.142 DN, their difference to 0.2 DN, five times that is 1.0 DN.
TEST(DoctorChecks, SeeTheLampWhenItIsBrighterThanTheNoiseOfBothReadings) {
  const api::DetectorReading dark{.unit = "DN", .value = 70.0, .noise = 3.0, .values = 448, .full_scale = 4095.0};
  const auto lit = [&](std::optional<double> value, std::int64_t saturated = 0) {
    api::DetectorReading reading = dark;
    reading.value = value;
    reading.saturated = saturated;
    return check_lit_reading(reading, dark).verdict;
  };

  EXPECT_EQ(lit(71.2), Verdict::Ok);
  EXPECT_EQ(lit(70.8), Verdict::Failed);
  EXPECT_EQ(lit(4000.0, 3), Verdict::Warning);
  EXPECT_EQ(lit(std::nullopt), Verdict::Warning) << "a radiometer's overload";
}

}  // namespace
}  // namespace gonio::cli
