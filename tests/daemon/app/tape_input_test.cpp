#include "daemon/tape/tape_input.h"

#include <gtest/gtest.h>

#include "tests/daemon/support/bench_instrument.h"

namespace gonio::daemon {
namespace {

SequencerMessage there_and_back(Verb verb) {
  const auto taped = tape_input_of(Command{.id = 7, .who = "uid:1000", .verb = std::move(verb)});
  EXPECT_TRUE(taped);
  const auto message = message_of(*taped, test::bench_instrument());
  EXPECT_TRUE(message) << describe(message.error());
  return message ? *message : SequencerMessage{};
}

TEST(TapeInput, KeepsAReadingByHandToTheNanosecond) {
  const auto message = there_and_back(
      ReadDetector{.exposure = std::chrono::nanoseconds(12'345'679), .range_w = std::nullopt, .lit = false});

  const auto& command = std::get<Command>(message);
  const auto& read = std::get<ReadDetector>(command.verb);
  EXPECT_EQ(command.id, 7U);
  EXPECT_EQ(read.exposure, std::chrono::nanoseconds(12'345'679));
  EXPECT_FALSE(read.range_w);
  EXPECT_EQ(read.lit, false);
}

TEST(TapeInput, KeepsARangeAndLeavesOpenWhatWasLeftOpen) {
  const auto message = there_and_back(ReadDetector{.range_w = 1e-3});

  const auto& read = std::get<ReadDetector>(std::get<Command>(message).verb);
  EXPECT_FALSE(read.exposure);
  EXPECT_EQ(read.range_w, 1e-3);
  EXPECT_FALSE(read.lit);
}

TEST(TapeInput, KeepsWhatCountsAsCalibrationAndWhatIsComputedAnew) {
  const auto use = std::get<UseCalibration>(
      std::get<Command>(there_and_back(UseCalibration{.version = 5, .in_use = false, .reason = "bent"})).verb);
  const auto with =
      std::get<RecomputeScan>(std::get<Command>(there_and_back(RecomputeScan{.scan = 3, .versions = {{5, 7}}})).verb);
  const auto open = std::get<RecomputeScan>(std::get<Command>(there_and_back(RecomputeScan{.scan = 3})).verb);

  EXPECT_EQ(use.version, 5);
  EXPECT_FALSE(use.in_use);
  EXPECT_EQ(use.reason, "bent");
  EXPECT_EQ(with.scan, 3);
  EXPECT_EQ(with.versions, (std::vector<CalibrationVersion>{5, 7}));
  EXPECT_FALSE(open.versions);
}

TEST(TapeInput, KeepsEveryPartOfAChange) {
  const ScanTurn::Start start{.at = Instant(std::chrono::nanoseconds(123'456'789)),
                              .utc = UtcTime(std::chrono::nanoseconds(1'795'000'000'123'456'789))};
  const auto message = there_and_back(ChangeScan{.scan = 12,
                                                 .target_snr = 0.1 + 0.2,
                                                 .max_time = std::chrono::nanoseconds(7),
                                                 .order = RestOrder::Fastest,
                                                 .seed = 18'446'744'073'709'551'615U,
                                                 .fastest = {3, 1, 2},
                                                 .priority = -7,
                                                 .start = start,
                                                 .reason = "a \"lamp\" that\nages"});

  const auto& change = std::get<ChangeScan>(std::get<Command>(message).verb);
  EXPECT_EQ(change.scan, 12);
  EXPECT_EQ(change.target_snr, 0.1 + 0.2) << "to the bit";
  EXPECT_EQ(change.max_time, std::chrono::nanoseconds(7));
  EXPECT_EQ(change.order, RestOrder::Fastest);
  EXPECT_EQ(change.seed, 18'446'744'073'709'551'615U);
  EXPECT_EQ(change.fastest, (std::vector<std::int32_t>{3, 1, 2}));
  EXPECT_EQ(change.priority, -7);
  ASSERT_TRUE(change.start);
  EXPECT_EQ(change.start->at, start.at);
  EXPECT_EQ(change.start->utc, start.utc);
  EXPECT_EQ(change.reason, "a \"lamp\" that\nages");
}

TEST(TapeInput, LeavesOfAChangeOpenWhatItLeavesOpen) {
  const auto message = there_and_back(ChangeScan{.scan = 12, .priority = 3});

  const auto& change = std::get<ChangeScan>(std::get<Command>(message).verb);
  EXPECT_FALSE(change.target_snr || change.max_time || change.order || change.start);
  EXPECT_TRUE(change.fastest.empty());
  EXPECT_EQ(change.priority, 3);
}

TEST(TapeInput, KeepsWhichHoldAResumeMeans) {
  const auto one = there_and_back(ResumeScan{.scan = 4, .hold = HoldName::Door});
  const auto all = there_and_back(ResumeScan{.scan = 4});

  EXPECT_EQ(std::get<ResumeScan>(std::get<Command>(one).verb).hold, HoldName::Door);
  EXPECT_FALSE(std::get<ResumeScan>(std::get<Command>(all).verb).hold);
}

TEST(TapeInput, KeepsWhatWasFreeOnTheDisk) {
  const auto taped = tape_input_of(DiskSeen{.free_bytes = 9'007'199'254'740'993});  // no double holds it
  ASSERT_TRUE(taped);

  const auto message = message_of(*taped, test::bench_instrument());

  ASSERT_TRUE(message) << describe(message.error());
  EXPECT_EQ(std::get<DiskSeen>(*message).free_bytes, 9'007'199'254'740'993);
}

// ---- scans ----

constexpr const char* kPlan =
    "[scan]\nname = 'n'\nsample = 's'\n[geometry]\ntheta_i_deg = [30]\ntheta_r_deg = [10, 20, 40]\nphi_r_deg = "
    "[90]\nwavelength_nm = [568]\n[reference]\nstandard = 'SRT-1'\n";

NewScan planned_scan(const std::string& more = {}) {
  NewScan scan;
  scan.plan_text = kPlan + more;
  scan.plan_file = "plan.toml";
  scan.reference_serial = "SRT-1";
  scan.who = "uid:1000";
  return scan;
}

NewScan scan_there_and_back(NewScan scan) {
  const auto message = there_and_back(SubmitScan{std::move(scan)});
  return std::get<SubmitScan>(std::get<Command>(message).verb).scan;
}

TEST(TapeInput, KeepsAScansTurn) {
  NewScan scan = planned_scan();
  const ScanTurn::Start start{.at = Instant(std::chrono::seconds(5)), .utc = UtcTime(std::chrono::seconds(99))};
  scan.turn = {.priority = 42, .preempts = true, .start = start};

  const NewScan back = scan_there_and_back(scan);

  EXPECT_EQ(back.turn.priority, 42);
  EXPECT_TRUE(back.turn.preempts);
  ASSERT_TRUE(back.turn.start);
  EXPECT_EQ(back.turn.start->at, start.at);
  EXPECT_EQ(back.turn.start->utc, start.utc);
  EXPECT_EQ(back.turn.completes, 0);
  EXPECT_EQ(back.planned.points.size(), 3U);
}

TEST(TapeInput, KeepsTheVeryPointsOfACompletionInTheirOrder) {
  NewScan scan = planned_scan();
  scan.turn.completes = 8;
  scan.policy.target_snr = 77.0;
  scan.policy.max_time = std::chrono::milliseconds(250);
  for (std::int32_t k = 0; k < 2; ++k) {
    ScanPoint point{.index = k, .rank = 1 - k};
    point.geometry = {.theta_i = degrees(30), .theta_r = degrees(10.0 / 3.0 + k), .phi_r = degrees(90)};
    point.wavelength = nanometres(568.0);
    point.repeat = 1 + k;
    scan.planned.points.push_back(point);
  }

  const NewScan back = scan_there_and_back(scan);

  EXPECT_EQ(back.turn.completes, 8);
  EXPECT_EQ(back.policy.target_snr, 77.0);
  EXPECT_EQ(back.policy.max_time, std::chrono::milliseconds(250));
  EXPECT_EQ(back.planned.order, (std::vector<std::int32_t>{1, 0}));
  ASSERT_EQ(back.planned.points.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(back.planned.points[k].geometry.theta_r.si(), scan.planned.points[k].geometry.theta_r.si());
    EXPECT_EQ(back.planned.points[k].repeat, scan.planned.points[k].repeat);
  }
}

TEST(TapeInput, KeepsWhatPastScansHadTaughtSoThatABudgetChoosesTheSamePoints) {
  NewScan scan = planned_scan("[budget]\ntime_min = 0.4\n");
  scan.planned.experience = {
      .scans = 3, .motion = {3.0, 0.01}, .beyond_s = {1.25, 0.5}, .white = {{nanometres(568.0), 1e5}}};

  const NewScan taught = scan_there_and_back(scan);
  scan.planned.experience = {};
  const NewScan untaught = scan_there_and_back(scan);

  EXPECT_EQ(taught.planned.experience.scans, 3);
  EXPECT_EQ(taught.planned.experience.beyond_s.value, 1.25);
  ASSERT_EQ(taught.planned.experience.white.size(), 1U);
  EXPECT_EQ(taught.planned.experience.white[0].dn_per_s, 1e5);
  EXPECT_LT(taught.planned.points.size(), untaught.planned.points.size());
}

}  // namespace
}  // namespace gonio::daemon
