#include "daemon/sequencer/sequencer.h"

#include <gtest/gtest.h>

#include "tests/daemon/sequencer/scan_rig.h"

namespace gonio::daemon {
namespace {

using calibration::Target;
using test::bench_plan;
using test::ScanRig;

api::Plan plan_of_three() {
  api::Plan plan = bench_plan({30}, {10, 20, 60}, {90});
  plan.target_snr = 300;
  return plan;
}

class SequencerScan : public testing::Test {
 protected:
  void run_to_item(int n) {
    ASSERT_TRUE(rig.run_until([&] { return rig.count("SELECT count(*) FROM item") >= n; }));
  }
  Result<CommandDone> answer(Verb verb) {
    const CommandId id = rig.command(std::move(verb));
    EXPECT_TRUE(rig.run_until([&] { return rig.reply_to(id) != nullptr; }));
    return rig.reply_to(id)->result;
  }
  std::vector<std::string> kinds() const {
    std::vector<std::string> all;
    for (const EventRecord& event : rig.events) all.push_back(event.kind);
    return all;
  }
  std::int64_t accepted() { return rig.count("SELECT count(*) FROM item WHERE outcome = 'accepted'"); }

  ScanRig rig;
};

TEST_F(SequencerScan, MeasuresEverySampleItemAndItsReferenceBetweenDarksAndParks) {
  const ScanId id = rig.submit(plan_of_three());

  rig.run_to_rest();

  const ScanInfo info = rig.info(id);
  EXPECT_EQ(info.state, ScanState::Done);
  EXPECT_EQ(info.counts.accepted, 6);
  EXPECT_EQ(info.counts.visits, 2);
  EXPECT_EQ(rig.world.stage.source_shutter, stage::ShutterState::Closed);
  EXPECT_EQ(rig.world.stage.detector_shutter, stage::ShutterState::Closed);
  EXPECT_FALSE(rig.status().active);
  EXPECT_EQ(rig.count("SELECT count(*) FROM reading"), rig.world.exposures) << "every exposure is stored";
}

TEST_F(SequencerScan, EventsTellTheLifeOfAScanInOrderAndWithoutGap) {
  rig.submit(plan_of_three());

  rig.run_to_rest();

  EXPECT_EQ(kinds(),
            (std::vector<std::string>{"scan-submitted", "scan-preparing", "scan-running", "dark-visit", "item-accepted",
                                      "item-accepted", "item-accepted", "item-accepted", "item-accepted",
                                      "item-accepted", "scan-finishing", "dark-visit", "scan-done"}));
  for (std::size_t k = 1; k < rig.events.size(); ++k) EXPECT_EQ(rig.events[k].number, rig.events[k - 1].number + 1);
}

TEST_F(SequencerScan, EveryUsedExposureHasItsDarkBeforeAndAfter) {
  rig.world.rate_dn_per_s = [](double theta_r, bool is_reference) { return is_reference ? 4e5 : 3e4 + 2e3 * theta_r; };
  rig.submit(plan_of_three());

  rig.run_to_rest();

  EXPECT_EQ(
      rig.count("SELECT count(*) FROM (SELECT DISTINCT exposure_ns e FROM reading WHERE attempt_id > 0 AND used = 1) "
                "WHERE (SELECT count(DISTINCT visit_id) FROM reading WHERE visit_id > 0 AND exposure_ns = e) < 2"),
      0);
}

TEST_F(SequencerScan, DarksAreTakenByTime) {
  api::Plan plan = plan_of_three();
  plan.dark_every = std::chrono::seconds(2);
  const ScanId id = rig.submit(plan);

  rig.run_to_rest();

  EXPECT_GT(rig.info(id).counts.visits, 3);
  EXPECT_EQ(accepted(), 6);
}

TEST_F(SequencerScan, TimesPartsAddUpToTheScansOwnTime) {
  const ScanId id = rig.submit(plan_of_three());
  rig.run_until([&] { return rig.state_of(id) == ScanState::Running; });
  const Instant began = rig.clock().now();

  rig.run_until([&] { return accepted() == 6; });

  const TimeParts spent = rig.info(id).spent;
  const double elapsed = in_seconds(rig.clock().now() - began);
  EXPECT_NEAR(in_seconds(spent.total()), elapsed, 0.01 * elapsed);
  EXPECT_GT(spent.move, spent.expose);
  EXPECT_GT(spent.settle, Duration::zero());
}

TEST_F(SequencerScan, TheRemainingTimeIsNamedWithItsUncertaintyAndComesTrue) {
  api::Plan plan = bench_plan({30}, {5, 10, 15, 20, 35, 40, 45, 50, 55, 60}, {60, 90, 120});
  const ScanId id = rig.submit(plan);
  run_to_item(30);
  const auto progress = rig.status().active;
  const Instant then = rig.clock().now();
  ASSERT_TRUE(progress && progress->remaining);

  rig.run_until([&] { return rig.state_of(id) == ScanState::Done; });

  const double took = in_seconds(rig.clock().now() - then);
  const double k = 3.0;  // of its own standard uncertainty, plus the parking it does not count
  EXPECT_NEAR(in_seconds(*progress->remaining), took, k * in_seconds(progress->u_remaining) + 0.2);
}

TEST_F(SequencerScan, PauseWaitsAfterTheItemAndResumeGoesOn) {
  const ScanId id = rig.submit(plan_of_three());
  rig.run_until([&] { return rig.status().doing == "exposing"; });

  ASSERT_TRUE(answer(PauseScan{.scan = id, .reason = "look at it"}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_EQ(accepted(), 1) << "the item in hand was finished";
  EXPECT_EQ(rig.status().active->holds[0].reason, "look at it");

  ASSERT_TRUE(answer(ResumeScan{id}));
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(accepted(), 6);
}

TEST_F(SequencerScan, PauseFinishesAnItemOfManyFrames) {
  rig.world.rate_dn_per_s = [](double, bool) { return 100.0; };
  const ScanId id = rig.submit(plan_of_three());
  rig.run_until([&] { return rig.status().doing == "exposing"; });
  for (int k = 0; k < 12; ++k) rig.step();

  ASSERT_TRUE(answer(PauseScan{.scan = id}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_EQ(accepted(), 1);
  EXPECT_GT(rig.count("SELECT count(*) FROM reading JOIN attempt USING (attempt_id) WHERE used = 1"), 5);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE outcome = 'dropped'"), 0);
}

TEST_F(SequencerScan, PauseNowDropsTheItemAndKeepsItsReadings) {
  rig.world.rate_dn_per_s = [](double, bool) { return 100.0; };  // many frames
  const ScanId id = rig.submit(plan_of_three());
  rig.run_until([&] { return rig.status().doing == "exposing"; });
  for (int k = 0; k < 12; ++k) rig.step();

  ASSERT_TRUE(answer(PauseScan{.scan = id, .now = true}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_EQ(accepted(), 0);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE outcome = 'dropped'"), 1);
  answer(ResumeScan{id});
  rig.run_to_rest();
  EXPECT_EQ(accepted(), 6);
}

TEST_F(SequencerScan, HoldsOverlapAndTheScanRunsWhenTheSetIsEmpty) {
  const ScanId id = rig.submit(plan_of_three());
  run_to_item(1);
  answer(PauseScan{.scan = id});
  rig.stop();
  rig.world.monitor = 0.01;
  rig.run_to_rest();
  ASSERT_EQ(rig.state_of(id), ScanState::Holding);

  EXPECT_EQ(answer(ResumeScan{id}).error().code, ErrorCode::WrongState) << "the stage is stopped";
  ASSERT_TRUE(answer(ClearStage{}));
  ASSERT_TRUE(answer(ResumeScan{id}));
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Holding) << "the lamp is out";
  EXPECT_EQ(rig.status().active->holds[0].name, HoldName::Lamp);

  rig.world.monitor = 1.0;
  ASSERT_TRUE(answer(ResumeScan{id}));
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
}

TEST(SequencerLamp, HoldsTheScanWhenItsMonitorDoesNotMove) {
  Instrument instrument = test::bench_instrument();
  instrument.lamp.least_scatter = 1e-6;
  ScanRig rig(std::move(instrument));
  const ScanId id = rig.submit(plan_of_three());

  rig.run_to_rest();  // the scripted monitor always says the same

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_EQ(rig.status().active->holds[0].name, HoldName::Lamp);
  EXPECT_NE(rig.status().active->holds[0].reason.find("stuck at 1"), std::string::npos);
}

TEST_F(SequencerScan, FinishEndsEarlyWithDataKeptAndAClosingDark) {
  const ScanId id = rig.submit(plan_of_three());
  run_to_item(2);

  ASSERT_TRUE(answer(FinishScan{id}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::FinishedEarly);
  EXPECT_LT(accepted(), 6);
  EXPECT_EQ(rig.info(id).counts.visits, 2);
  EXPECT_EQ(rig.world.stage.source_shutter, stage::ShutterState::Closed);
}

TEST_F(SequencerScan, FinishWorksFromAHoldToo) {
  const ScanId id = rig.submit(plan_of_three());
  run_to_item(2);
  answer(PauseScan{.scan = id});
  rig.run_to_rest();

  ASSERT_TRUE(answer(FinishScan{id}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::FinishedEarly);
}

TEST_F(SequencerScan, AbortEndsAtOnceAndClosesTheShutters) {
  const ScanId id = rig.submit(plan_of_three());
  run_to_item(2);

  ASSERT_TRUE(answer(AbortScan{.scan = id, .reason = "wrong sample"}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Aborted);
  EXPECT_EQ(rig.info(id).outcome, "wrong sample");
  EXPECT_EQ(rig.world.stage.source_shutter, stage::ShutterState::Closed);
}

TEST_F(SequencerScan, SkipGivesUpTheItemInHandAndItsPartner) {
  const ScanId id = rig.submit(plan_of_three());
  rig.run_until([&] { return rig.status().active && rig.status().active->in_hand; });

  ASSERT_TRUE(answer(SkipItemInHand{id}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(rig.info(id).counts.skipped, 2);
  EXPECT_EQ(accepted(), 4);
}

TEST_F(SequencerScan, StopAtEveryStepDropsTheItemHoldsAndGoesOnAfterResetAndResume) {
  int steps = 0;
  {
    ScanRig unbroken;
    unbroken.submit(plan_of_three());
    while (unbroken.step()) ++steps;
  }
  for (int stop_after = 0; stop_after < steps; stop_after += 3) {
    SCOPED_TRACE("STOP after step " + std::to_string(stop_after));
    ScanRig stopped;
    const ScanId id = stopped.submit(plan_of_three());
    for (int k = 0; k < stop_after; ++k) stopped.step();
    stopped.stop();
    stopped.run_to_rest();
    if (!is_over(stopped.state_of(id))) {
      EXPECT_EQ(stopped.state_of(id), ScanState::Holding);
      const CommandId early = stopped.command(ResumeScan{id});
      stopped.run_to_rest();
      EXPECT_EQ(stopped.reply_to(early)->result.error().code, ErrorCode::WrongState);
      stopped.command(ClearStage{});
      stopped.run_to_rest();
      const CommandId resumed = stopped.command(ResumeScan{id});
      stopped.run_to_rest();
      EXPECT_TRUE(stopped.reply_to(resumed)->result);
    }
    EXPECT_EQ(stopped.state_of(id), ScanState::Done);
    EXPECT_EQ(stopped.info(id).counts.accepted, 6);
    if (testing::Test::HasFailure()) return;
  }
}

TEST_F(SequencerScan, HomesBeforeItTriesAgainWhenAnAxisWasNotWhereItWasLeft) {
  bool has_slipped = false;
  rig.world.move_error = [&](const MoveTo& to) -> std::optional<Error> {
    const auto& theta_r = to.target[stage::index_of(stage::Axis::ThetaR)];
    if (has_slipped || !theta_r || *theta_r < 59.0) return std::nullopt;
    has_slipped = true;
    rig.world.stage.homed = false;  // only homing sets it again
    return Error{.code = ErrorCode::OutOfTolerance, .device = "stage"};
  };
  const ScanId id = rig.submit(plan_of_three());

  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_TRUE(has_slipped && rig.world.stage.homed);
  EXPECT_EQ(accepted(), 6);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE error_code = 'out-of-tolerance'"), 1);
}

TEST_F(SequencerScan, ALateMoveIsTriedAgainThenSkippedAndRecorded) {
  rig.world.move_error = [](const MoveTo& to) -> std::optional<Error> {
    const auto& theta_r = to.target[stage::index_of(stage::Axis::ThetaR)];
    if (!theta_r || *theta_r < 59.0) return std::nullopt;
    return Error{.code = ErrorCode::MotionLate, .seen = "still moving"};
  };
  const ScanId id = rig.submit(plan_of_three());

  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(accepted(), 4);
  EXPECT_EQ(rig.info(id).counts.skipped, 2);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE outcome = 'failed' AND error_code = 'motion-late'"), 3);
}

TEST_F(SequencerScan, OnErrorHoldHoldsAndTheOperatorsResumeTriesAgain) {
  bool is_late = true;
  rig.world.move_error = [&](const MoveTo& to) -> std::optional<Error> {
    const auto& theta_r = to.target[stage::index_of(stage::Axis::ThetaR)];
    if (!is_late || !theta_r || *theta_r < 59.0) return std::nullopt;
    return Error{.code = ErrorCode::MotionLate, .seen = "still moving"};
  };
  api::Plan plan = plan_of_three();
  plan.on_item_error = api::OnItemError::Hold;
  const ScanId id = rig.submit(plan);
  rig.run_to_rest();
  ASSERT_EQ(rig.state_of(id), ScanState::Holding);
  is_late = false;

  answer(ResumeScan{id});
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(accepted(), 6);
}

TEST_F(SequencerScan, OnErrorFailFailsTheScan) {
  rig.world.rate_dn_per_s = [](double, bool) { return 1e9; };
  api::Plan plan = plan_of_three();
  plan.on_item_error = api::OnItemError::Fail;
  const ScanId id = rig.submit(plan);

  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Failed);
  EXPECT_NE(rig.info(id).outcome.find("full scale"), std::string::npos);
}

TEST_F(SequencerScan, ALostCameraHoldsWithTheReasonAndGoesOnWhenItIsBack) {
  const Error lost{.code = ErrorCode::Unreachable, .device = "detector", .tried = "take a frame", .seen = "no answer"};
  const ScanId id = rig.submit(plan_of_three());
  run_to_item(2);
  rig.world.frame_error = [lost] { return lost; };
  rig.world.camera_open_error = [lost] { return lost; };
  rig.run_to_rest();
  ASSERT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_EQ(rig.status().active->holds[0].name, HoldName::Device);
  EXPECT_NE(rig.status().active->holds[0].reason.find("no answer"), std::string::npos);

  answer(ResumeScan{id});
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Holding) << "still away";

  rig.world.frame_error = [] { return std::nullopt; };
  rig.world.camera_open_error = [] { return std::nullopt; };
  answer(ResumeScan{id});
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(accepted(), 6);
}

TEST_F(SequencerScan, ACameraThatIsSlowToFailIsNamedAndNotTheGateThatNeverOpened) {
  const ScanId id = rig.submit(plan_of_three());
  run_to_item(1);
  rig.world.frame_error_after = std::chrono::seconds(4);
  rig.world.frame_error = [] { return Error{.code = ErrorCode::Unreachable, .device = "detector", .tried = "frame"}; };

  rig.run_to_rest();

  ASSERT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_NE(rig.status().active->holds[0].reason.find("detector"), std::string::npos);
}

TEST_F(SequencerScan, FramesThatKeepTimingOutHoldInsteadOfSkippingEverything) {
  const ScanId id = rig.submit(plan_of_three());
  run_to_item(1);
  rig.world.frame_error = [] { return Error{.code = ErrorCode::TimedOut, .device = "detector", .tried = "frame"}; };

  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_EQ(rig.info(id).counts.skipped, 0);
}

TEST_F(SequencerScan, AnOpenDoorHoldsAsDoor) {
  const ScanId id = rig.submit(plan_of_three());
  run_to_item(1);
  rig.world.move_error = [](const MoveTo&) { return Error{.code = ErrorCode::Interlock}; };

  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_EQ(rig.status().active->holds[0].name, HoldName::Door);
}

TEST_F(SequencerScan, AFailedCommitHoldsAndAResumeGoesOnFromWhatIsDurable) {
  const ScanId id = rig.submit(plan_of_three());
  run_to_item(2);
  rig.refuse_commits = true;
  rig.run_to_rest();
  ASSERT_TRUE(rig.status().store_error);
  EXPECT_EQ(rig.status().store_error->code, ErrorCode::DiskFull);
  EXPECT_EQ(rig.status().active->holds[0].name, HoldName::Disk);
  const int exposures = rig.world.exposures;
  rig.run_to_rest();
  EXPECT_EQ(rig.world.exposures, exposures) << "nothing is exposed that cannot be kept";

  rig.refuse_commits = false;
  ASSERT_TRUE(answer(ResumeScan{id}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(accepted(), 6);
}

TEST_F(SequencerScan, TheNextExposureWaitsForTheCommitWhileTheMoveDoesNot) {
  rig.submit(plan_of_three());
  run_to_item(1);  // executed by the store, its answer not yet delivered
  const int exposures = rig.world.exposures;

  EXPECT_NE(rig.status().doing, "exposing");
  const auto before = rig.events.size();
  rig.run_until([&] { return rig.world.exposures > exposures; });
  EXPECT_EQ(rig.events.size(), before) << "no second item was committed meanwhile";
}

TEST_F(SequencerScan, ByHandOnlyWhileNoScanRuns) {
  drivers::MotionTarget target{};
  target[stage::index_of(stage::Axis::ThetaR)] = 40.0;
  ASSERT_TRUE(answer(MoveStage{.target = target}));
  EXPECT_EQ(rig.world.stage.axes[stage::index_of(stage::Axis::ThetaR)].position, 40.0);
  ASSERT_TRUE(answer(HomeStage{}));

  const ScanId id = rig.submit(plan_of_three());
  run_to_item(1);
  EXPECT_EQ(answer(MoveStage{.target = target}).error().code, ErrorCode::WrongState);
  answer(PauseScan{.scan = id});
  rig.run_to_rest();
  EXPECT_TRUE(answer(MoveStage{.target = target})) << "allowed on hold";
}

TEST_F(SequencerScan, AMoveByHandClearsATrippedHeartbeatButNeverAStop) {
  drivers::MotionTarget target{};
  target[stage::index_of(stage::Axis::ThetaR)] = 40.0;
  rig.world.stage.heartbeat_tripped = true;
  EXPECT_TRUE(answer(MoveStage{.target = target}));
  EXPECT_FALSE(rig.world.stage.heartbeat_tripped);

  rig.stop();
  EXPECT_EQ(answer(MoveStage{.target = target}).error().code, ErrorCode::Stopped);
  EXPECT_TRUE(rig.world.stage.halted);
}

TEST_F(SequencerScan, AMoveByHandIntoTheShadowIsBlockedAndSendsNothing) {
  rig.world.stage.axes[stage::index_of(stage::Axis::ThetaI)].position = 30.0;
  drivers::MotionTarget target{};
  target[stage::index_of(stage::Axis::ThetaR)] = 29.0;

  EXPECT_EQ(answer(MoveStage{.target = target}).error().code, ErrorCode::Blocked);

  EXPECT_EQ(rig.world.stage.axes[stage::index_of(stage::Axis::ThetaR)].position, 0.0);
}

TEST_F(SequencerScan, CommandsForScansThatAreNotThereOrNotInThatStateAreRefused) {
  EXPECT_EQ(answer(PauseScan{.scan = 99}).error().code, ErrorCode::NotFound);
  const ScanId id = rig.submit(plan_of_three());
  run_to_item(1);
  EXPECT_EQ(answer(ResumeScan{id}).error().code, ErrorCode::WrongState);
  EXPECT_EQ(answer(AbortScan{.scan = 99}).error().code, ErrorCode::NotFound);
}

TEST_F(SequencerScan, AQueuedScanCanBeAbortedAndTheFirstIsNotDisturbed) {
  const ScanId first = rig.submit(plan_of_three());
  const ScanId second = rig.submit(plan_of_three());

  ASSERT_TRUE(answer(AbortScan{.scan = second}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(first), ScanState::Done);
  EXPECT_EQ(rig.state_of(second), ScanState::Aborted);
}

TEST_F(SequencerScan, AnExposureThatTheGateDidNotCountIsRefused) {
  const ScanId id = rig.submit(plan_of_three());
  run_to_item(1);
  bool meddle = true;
  auto rate = rig.world.rate_dn_per_s;
  rig.world.rate_dn_per_s = [&, rate](double theta, bool is_reference) {
    if (std::exchange(meddle, false)) ++rig.world.stage.gate.count;  // somebody else exposed meanwhile
    return rate(theta, is_reference);
  };

  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(accepted(), 6);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE error_code = 'stale-data'"), 1);
}

}  // namespace
}  // namespace gonio::daemon
