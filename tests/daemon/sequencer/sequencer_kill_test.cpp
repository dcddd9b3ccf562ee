#include <gtest/gtest.h>

#include "tests/daemon/sequencer/scan_rig.h"

namespace gonio::daemon {
namespace {

using calibration::Target;
using test::bench_plan;
using test::ScanRig;

api::Plan small_plan() {
  api::Plan plan = bench_plan({30}, {10, 20}, {90});
  plan.target_snr = 200;
  plan.max_time = std::chrono::milliseconds(2);
  return plan;
}

int steps_of_unbroken_scan(Duration frame_takes) {
  ScanRig rig;
  rig.world.frame_takes = frame_takes;
  rig.submit(small_plan());
  int steps = 0;
  while (rig.step()) ++steps;
  return steps;
}

// Every item accepted once, its event published once and before anything else was told; no exposure without a trace but
// at most one item's.
void expect_nothing_lost_or_doubled(ScanRig& rig, ScanId id, int kills) {
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(rig.count("SELECT count(*) FROM item WHERE outcome = 'accepted'"), 4);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE outcome = 'accepted'"), 4);
  EXPECT_EQ(rig.count("SELECT count(*) FROM event WHERE kind = 'item-accepted'"), 4);
  EXPECT_EQ(rig.count("SELECT count(*) FROM event"), rig.count("SELECT max(number) FROM event"));
  for (const auto& [item, exposures] : rig.world.exposed_at) {
    const std::string stored =
        "SELECT count(*) FROM reading JOIN attempt USING (attempt_id) JOIN point USING (scan_id, "
        "point_index) WHERE target = '" +
        std::string(target_name(item.target)) + "' AND round(theta_r_deg) = " + std::to_string(item.point);
    EXPECT_LE(exposures, rig.count(stored) + 3 * kills) << "an item has three frames at most here";
  }
}

// Of the two readings of the standard and all darks.
void kill_a_map_job_at_every_step() {
  ScanRig unbroken;
  unbroken.submit(test::map_plan());
  int steps = 0;
  while (unbroken.step()) ++steps;
  ASSERT_GT(steps, 50);

  for (int kill_after = 1; kill_after <= steps && !testing::Test::HasFailure(); ++kill_after) {
    SCOPED_TRACE("killed after step " + std::to_string(kill_after));
    ScanRig rig;
    const ScanId id = rig.submit(test::map_plan());
    for (int k = 0; k < kill_after; ++k) rig.step();
    rig.kill();
    rig.start();
    rig.run_to_rest();

    EXPECT_EQ(rig.state_of(id), ScanState::Done);
    EXPECT_EQ(rig.count("SELECT count(*) FROM item WHERE outcome = 'accepted'"), 4);
    test::expect_sums_of_whole_readings(rig, id);
  }
}

void kill_at_every_step(Duration frame_takes) {
  const int steps = steps_of_unbroken_scan(frame_takes);
  ASSERT_GT(steps, 50);

  for (int kill_after = 1; kill_after <= steps; ++kill_after) {
    SCOPED_TRACE("killed after step " + std::to_string(kill_after));
    ScanRig rig;
    rig.world.frame_takes = frame_takes;
    const ScanId id = rig.submit(small_plan());
    for (int k = 0; k < kill_after; ++k) rig.step();
    const auto heard = rig.events;
    const std::int64_t accepted_before = rig.count("SELECT count(*) FROM item");

    rig.kill();
    rig.start();
    rig.run_to_rest();

    expect_nothing_lost_or_doubled(rig, id, 1);
    const auto replayed = StoreReader::open(rig.store_path()).value()->events(0, 10'000, 0);
    ASSERT_TRUE(replayed);
    for (const EventRecord& event : heard) {
      const EventRecord& kept = (*replayed)[static_cast<std::size_t>(event.number - 1)];
      EXPECT_EQ(kept.number, event.number);
      EXPECT_EQ(kept.json, event.json);
    }
    int repeated_items = 0;
    for (const auto& [item, exposures] : rig.world.exposed_at) {
      const std::string stored =
          "SELECT count(*) FROM reading JOIN attempt USING (attempt_id) JOIN point USING (scan_id, "
          "point_index) WHERE target = '" +
          std::string(target_name(item.target)) + "' AND round(theta_r_deg) = " + std::to_string(item.point);
      if (exposures > rig.count(stored)) ++repeated_items;
    }
    EXPECT_LE(repeated_items, 1) << "at most one item is exposed again";
    EXPECT_GE(rig.count("SELECT count(*) FROM item"), accepted_before);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(SequencerKill, KilledAtEveryStepOfAScanItLosesAndDoublesNothing) {
  kill_at_every_step(std::chrono::milliseconds(2));
}

TEST(SequencerKill, KilledAtEveryStepOfAMapJobItsSumsAreThoseOfWholeReadings) {
  kill_a_map_job_at_every_step();
}

TEST(SequencerKill, AnOrdinaryScanKeepsNoSums) {
  ScanRig rig;
  const ScanId id = rig.submit(small_plan());
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(rig.count("SELECT count(*) FROM pixel_sum"), 0);
}

TEST(SequencerKill, NorDoesItWhereTheArmsLeaveLongBeforeTheFrameComes) {
  kill_at_every_step(std::chrono::seconds(2));
}

TEST(SequencerKill, KilledAgainAndAgainItStillArrives) {
  ScanRig rig;
  const ScanId id = rig.submit(small_plan());

  // Progress is made only if the time between kills allows an item: it grows, as an operator's patience would not.
  for (int kills = 1; kills <= 25; ++kills) {
    for (int k = 0; k < 5 + 9 * kills; ++k) rig.step();
    rig.kill();
    rig.start();
  }
  rig.run_to_rest();

  expect_nothing_lost_or_doubled(rig, id, 25);
}

TEST(SequencerKill, AScanOnHoldIsStillOnHoldAfterAKill) {
  ScanRig rig;
  const ScanId id = rig.submit(small_plan());
  rig.run_until([&] { return rig.state_of(id) == ScanState::Running; });
  rig.command(PauseScan{.scan = id, .reason = "lunch"});
  rig.run_to_rest();
  ASSERT_EQ(rig.state_of(id), ScanState::Holding);

  rig.kill();
  rig.start();
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  ASSERT_EQ(rig.status().active->holds.size(), 1U);
  EXPECT_EQ(rig.status().active->holds[0].reason, "lunch");
  rig.command(ResumeScan{id});
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
}

TEST(SequencerKill, APlanThatAsksToHoldAfterARestartHolds) {
  ScanRig rig;
  api::Plan plan = small_plan();
  plan.on_restart = api::OnRestart::Hold;
  const ScanId id = rig.submit(plan);
  rig.run_until([&] { return rig.state_of(id) == ScanState::Running; });

  rig.kill();
  rig.start();
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_EQ(rig.status().active->holds[0].name, HoldName::Restart);
}

TEST(SequencerKill, AStageThatLostItsHomeMeanwhileIsHomedBeforeItGoesOn) {
  ScanRig rig;
  const ScanId id = rig.submit(small_plan());
  rig.run_until([&] { return rig.count("SELECT count(*) FROM item") == 1; });

  rig.kill();
  rig.world.stage.homed = false;
  ++rig.world.stage.boot_counter;
  rig.start();
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_TRUE(rig.world.stage.homed);
}

TEST(SequencerKill, AHeartbeatThatTrippedMeanwhileIsClearedByTheNextDaemon) {
  ScanRig rig;
  const ScanId id = rig.submit(small_plan());
  rig.run_until([&] { return rig.count("SELECT count(*) FROM item") == 1; });

  rig.kill();
  rig.world.stage.heartbeat_tripped = true;
  rig.start();
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
}

TEST(SequencerKill, AStopGivenBeforeTheKillStandsAfterIt) {
  ScanRig rig;
  const ScanId id = rig.submit(small_plan());
  rig.run_until([&] { return rig.count("SELECT count(*) FROM item") == 1; });
  rig.stop();

  rig.kill();
  rig.start();
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_TRUE(rig.world.stage.halted);
}

TEST(SequencerKill, AFinishThatWasAskedForIsStillWantedAfterAKill) {
  ScanRig rig;
  const ScanId id = rig.submit(small_plan());
  rig.run_until([&] { return rig.count("SELECT count(*) FROM item") == 1; });
  rig.command(FinishScan{id});
  rig.run_until([&] { return rig.state_of(id) == ScanState::Finishing; });

  rig.kill();
  rig.start();
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::FinishedEarly);
}

TEST(SequencerKill, AChangedInstrumentHolds) {
  ScanRig rig;
  api::Plan plan = small_plan();
  NewScan scan = test::new_scan(plan);
  scan.instrument_hash = "another";
  rig.command(SubmitScan{scan});
  rig.run_to_rest();

  ASSERT_TRUE(rig.status().active);
  EXPECT_EQ(rig.status().active->state, ScanState::Holding);
  EXPECT_EQ(rig.status().active->holds[0].name, HoldName::Restart);
}

TEST(SequencerKill, QueuedScansAreStillQueuedAndRunInTheirTurn) {
  ScanRig rig;
  const ScanId first = rig.submit(small_plan());
  const ScanId second = rig.submit(small_plan());

  rig.kill();
  rig.start();
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(first), ScanState::Done);
  EXPECT_EQ(rig.state_of(second), ScanState::Done);
}

}  // namespace
}  // namespace gonio::daemon
