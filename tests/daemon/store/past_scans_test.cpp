// What finished scans teach about the next one's time.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "daemon/store/store_reader.h"
#include "daemon/store/store_writer.h"
#include "tests/daemon/support/scan_records.h"

namespace gonio::daemon {
namespace {

using calibration::Target;

class PastScans : public testing::Test {
 protected:
  PastScans() {
    writer_ = std::move(StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_)).value();
    reader_ = std::move(StoreReader::open(path_)).value();
  }

  ScanId commit(std::vector<StoreWrite> writes, std::vector<NewEvent> events = {}) {
    const auto receipt =
        writer_->commit({.at = clock_.now(), .writes = std::move(writes), .events = std::move(events)});
    EXPECT_TRUE(receipt) << describe(receipt.error());
    return receipt ? receipt->new_scan : 0;
  }

  // Predicted by the axes' numbers to move and settle for 100 s; took so much, and so much beyond for its 8 items.
  ScanId finished(double motion_s, double beyond_s, double by_ratio = 1.0, ScanState end = ScanState::Done) {
    NewScan scan = test::new_scan(test::bench_plan({60}, {10, 20, 40, 50}, {90}));
    scan.planned.estimate = {.move = seconds(80.0 * by_ratio), .settle = seconds(20.0 * by_ratio)};
    scan.planned.experience.motion.value = by_ratio;
    const ScanId id = commit({scan});
    ScanState from = ScanState::Queued;
    for (const ScanState to : {ScanState::Preparing, ScanState::Running, ScanState::Finishing}) {
      commit({ScanTransition{.scan = id, .from = from, .to = to, .who = "test"}});
      from = to;
    }
    const std::string json = fmt::format(
        R"({{"accepted":8,"time":{{"move_s":{},"settle_s":1.0,"expose_s":3.0,"read_s":{},)"
        R"("idle_by":{{"commit_s":0.25,"wire_s":0.5,"device_s":1000.0,"hold_s":1000.0,"planning_s":0.25}}}}}})",
        motion_s - 1.0, beyond_s - 1.0);
    commit({ScanTransition{.scan = id, .from = from, .to = end, .who = "test"}},
           {NewEvent{.kind = "scan-" + std::string(scan_state_name(end)), .scan = id, .who = "test", .json = json}});
    return id;
  }

  TimeExperience learned() {
    const auto experience = reader_->time_experience(test::bench_instrument().sha256);
    EXPECT_TRUE(experience) << describe(experience.error());
    return experience.value_or(TimeExperience{});
  }

  test::ScratchFolder folder_;
  std::string path_ = folder_.file("store.sqlite");
  ManualClock clock_;
  std::unique_ptr<StoreWriter> writer_;
  std::unique_ptr<StoreReader> reader_;
};

TEST_F(PastScans, OfAnEmptyStoreTeachNothing) {
  EXPECT_EQ(learned().scans, 0);
  EXPECT_EQ(learned().motion.value, 1.0);
}

TEST_F(PastScans, TeachByCauseWithTheScatterBetweenThem) {
  finished(104.0, 16.0);
  finished(108.0, 24.0);

  const TimeExperience experience = learned();

  EXPECT_EQ(experience.scans, 2);
  EXPECT_NEAR(experience.motion.value, 1.06, 1e-9);
  // Two values 0.04 apart: s = 0.04 / sqrt(2); of a third one s sqrt(1 + 1/2).
  EXPECT_NEAR(experience.motion.u, 0.04 / std::sqrt(2.0) * std::sqrt(1.5), 1e-9);
  EXPECT_NEAR(experience.beyond_s.value, 2.5, 1e-9) << "16 s and 24 s for 8 items, holds and devices left out";
}

TEST_F(PastScans, AreComparedWithTheAxesNumbersAndNotWithWhatWasLearnedBefore) {
  finished(104.0, 16.0, 1.04);

  EXPECT_NEAR(learned().motion.value, 1.04, 1e-9);
}

TEST_F(PastScans, ThatEndedEarlyOrOnAnotherConfigurationTeachNothing) {
  finished(200.0, 16.0, 1.0, ScanState::FinishedEarly);
  finished(104.0, 16.0);

  EXPECT_EQ(learned().scans, 1);
  EXPECT_NEAR(learned().motion.value, 1.04, 1e-9);
  EXPECT_EQ(reader_->time_experience("another hash")->scans, 0);
}

TEST_F(PastScans, TellWhatTheDetectorSeesOfTheStandard) {
  const ScanId id = finished(104.0, 16.0);
  commit({NewVisit{.scan = id, .readings = {test::reading_of(100.0, clock_.now())}, .started = clock_.now()}});
  commit({NewAttempt{.scan = id,
                     .item = {0, Target::Reference},
                     .readings = {test::reading_of(300.0, clock_.now())},
                     .started = clock_.now()}});

  const TimeExperience experience = learned();

  // 200 DN above the dark in 4 ms, at 60 deg: half the light of theta_i = 0.
  ASSERT_EQ(experience.white.size(), 1U);
  EXPECT_NEAR(in_nanometres(experience.white[0].wavelength), 568.0, 1e-9);
  EXPECT_NEAR(experience.white[0].dn_per_s, 200.0 / 0.004 / 0.5, 1e-6);
}

TEST_F(PastScans, WhatAScanWasPredictedToTakeIsThereAfterARestart) {
  NewScan scan = test::new_scan(test::bench_plan({30}, {10}, {90}));
  scan.planned.u_estimate_s = 12.5;
  scan.planned.experience = {.scans = 7, .motion = {1.02, 0.01}};
  commit({scan});

  const auto unfinished = writer_->unfinished();

  ASSERT_TRUE(unfinished && unfinished->size() == 1);
  ASSERT_TRUE(unfinished->front().predicted);
  EXPECT_EQ(unfinished->front().predicted->total, scan.planned.estimate.total());
  EXPECT_EQ(unfinished->front().predicted->u_s, 12.5);
  EXPECT_EQ(unfinished->front().predicted->motion.value, 1.02);
  EXPECT_EQ(unfinished->front().predicted->scans, 7);
}

}  // namespace
}  // namespace gonio::daemon
