// Turns, pre-emption, holds that end by themselves, changes of the rest: whole scans on the scripted instrument.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/daemon/sequencer/scan_rig.h"

namespace gonio::daemon {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using test::ScanRig;
using testing::HasSubstr;

class ScanTurns : public testing::Test {
 protected:
  explicit ScanTurns(Instrument instrument = test::bench_instrument()) : rig(std::move(instrument)) {}

  ScanId submit(ScanTurn turn = {}, const std::vector<double>& theta_r = {10, 20, 60}) {
    NewScan scan = test::new_scan(test::bench_plan({30}, theta_r, {90}));
    scan.turn = turn;
    return answer(SubmitScan{std::move(scan)})->scan;
  }
  Result<CommandDone> answer(Verb verb) {
    const CommandId id = rig.command(std::move(verb));
    EXPECT_TRUE(rig.run_until([&] { return rig.reply_to(id) != nullptr; }));
    return rig.reply_to(id)->result;
  }
  // The scans, in the order in which an event of this kind came.
  std::vector<ScanId> order_of(const std::string& kind) const {
    std::vector<ScanId> order;
    for (const EventRecord& event : rig.events) {
      if (event.kind == kind) order.push_back(event.scan);
    }
    return order;
  }
  void until_item() {
    const std::int64_t before = rig.count("SELECT count(*) FROM item");
    ASSERT_TRUE(rig.run_until([&] { return rig.count("SELECT count(*) FROM item") > before; }));
  }
  [[nodiscard]] std::vector<HoldName> holds() const {
    std::vector<HoldName> names;
    const SequencerStatus status = rig.status();
    if (!status.active) return names;
    for (const Hold& hold : status.active->holds) names.push_back(hold.name);
    return names;
  }

  ScanRig rig;
};

TEST_F(ScanTurns, HigherPrioritiesGoFirstAndOfEqualOnesTheOlder) {
  const ScanId running = submit();
  const ScanId low = submit({.priority = -1});
  const ScanId older = submit({.priority = 3});
  const ScanId younger = submit({.priority = 3});
  EXPECT_EQ(rig.status().queued, (std::vector<ScanId>{older, younger, low}));

  rig.run_to_rest();

  EXPECT_EQ(order_of("scan-done"), (std::vector<ScanId>{running, older, younger, low}));
}

TEST_F(ScanTurns, AScanDoesNotStartBeforeItsTimeAndLetsOthersPass) {
  const Instant at = rig.clock().now() + hours(2);
  const ScanId later =
      submit({.priority = 9, .start = ScanTurn::Start{.at = at, .utc = rig.clock().utc_now() + hours(2)}});
  const ScanId now = submit();

  ASSERT_TRUE(rig.run_until([&] { return rig.state_of(now) == ScanState::Done; }));
  EXPECT_LT(rig.clock().now(), at);
  EXPECT_EQ(rig.state_of(later), ScanState::Queued);
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(later), ScanState::Done);
  EXPECT_GE(rig.clock().now(), at);
}

TEST_F(ScanTurns, AnUrgentScanRunsInsideALongOneAtAPointBoundaryAndTheLongOneGoesOnByItself) {
  const ScanId longer = submit({}, {10, 20, 40, 50, 60});
  until_item();
  const ScanId urgent = submit({.priority = 5, .preempts = true}, {20});

  ASSERT_TRUE(rig.run_until([&] { return rig.status().active && rig.status().active->scan == urgent; }));
  EXPECT_EQ(rig.status().aside, std::vector<ScanId>{longer});
  EXPECT_EQ(rig.state_of(longer), ScanState::Holding);
  EXPECT_EQ(rig.info(longer).holds.at(0).name, HoldName::Preempted);
  EXPECT_EQ(rig.count("SELECT count(*) FROM item s WHERE target = 'sample' AND NOT EXISTS (SELECT 1 FROM item r WHERE "
                      "r.point_index = s.point_index AND r.target = 'reference')"),
            0)
      << "no point waits half measured";
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE attempt_id > (SELECT max(after_attempt) FROM visit)"), 0)
      << "its dark was taken before";
  rig.run_to_rest();

  EXPECT_EQ(order_of("scan-done"), (std::vector<ScanId>{urgent, longer}));
  EXPECT_EQ(rig.info(longer).counts.accepted, 10);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE outcome <> 'accepted'"), 0);
}

TEST_F(ScanTurns, AScanOfTheSamePriorityWaitsEvenIfItMayPreempt) {
  const ScanId first = submit();
  until_item();
  const ScanId second = submit({.preempts = true});

  rig.run_to_rest();

  EXPECT_EQ(order_of("scan-done"), (std::vector<ScanId>{first, second}));
  EXPECT_EQ(rig.count("SELECT count(*) FROM hold"), 0);
}

TEST_F(ScanTurns, NothingRunsInsideAScanThatTheOperatorHolds) {
  const ScanId first = submit();
  until_item();
  ASSERT_TRUE(answer(PauseScan{.scan = first, .reason = "hands in the instrument"}));
  const ScanId urgent = submit({.priority = 5, .preempts = true});
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(urgent), ScanState::Queued);
  ASSERT_TRUE(answer(ResumeScan{.scan = first}));
  rig.run_to_rest();
  EXPECT_EQ(order_of("scan-done"), (std::vector<ScanId>{urgent, first}));
}

TEST_F(ScanTurns, AKillAtEveryStepOfAPreemptionLosesNeitherScan) {
  for (int kill_after = 0; kill_after < 400; kill_after += 7) {
    SCOPED_TRACE("killed after step " + std::to_string(kill_after));
    ScanRig one;
    const auto submit_to = [&](ScanTurn turn, const std::vector<double>& theta_r) {
      NewScan scan = test::new_scan(test::bench_plan({30}, theta_r, {90}));
      scan.turn = turn;
      const CommandId id = one.command(SubmitScan{std::move(scan)});
      one.run_until([&] { return one.reply_to(id) != nullptr; });
      return one.reply_to(id)->result->scan;
    };
    const ScanId longer = submit_to({}, {10, 20, 40});
    one.run_until([&] { return one.count("SELECT count(*) FROM item") == 1; });
    const ScanId urgent = submit_to({.priority = 5, .preempts = true}, {20});
    for (int k = 0; k < kill_after; ++k) one.step();

    one.kill();
    one.start();
    one.run_to_rest();

    EXPECT_EQ(one.state_of(longer), ScanState::Done);
    EXPECT_EQ(one.state_of(urgent), ScanState::Done);
    EXPECT_EQ(one.info(longer).counts.accepted, 6);
    EXPECT_EQ(one.info(urgent).counts.accepted, 2);
    if (testing::Test::HasFailure()) return;
  }
}

TEST_F(ScanTurns, ResumeEndsWhatIsGoneAndNamesWhatIsLeft) {
  const ScanId id = submit();
  until_item();
  rig.world.monitor = 0.01;
  rig.run_to_rest();
  ASSERT_TRUE(answer(PauseScan{.scan = id}));
  rig.run_to_rest();

  const auto resumed = answer(ResumeScan{.scan = id});

  ASSERT_TRUE(resumed) << describe(resumed.error());
  EXPECT_THAT(resumed->note, HasSubstr("still held: lamp (stage: lamp monitor 0.01"));
  EXPECT_EQ(holds(), std::vector<HoldName>{HoldName::Lamp});
  rig.world.monitor = 1.0;
  EXPECT_TRUE(answer(ResumeScan{.scan = id})) << "a fresh look is taken first";
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
}

TEST_F(ScanTurns, ADoorThatOpensWhileTheScanRunsDropsTheItemAndHolds) {
  const ScanId id = submit();
  ASSERT_TRUE(rig.run_until([&] { return rig.status().doing == "exposing"; }));

  rig.world.stage.interlock_open = true;
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_EQ(holds(), std::vector<HoldName>{HoldName::Door});
  EXPECT_FALSE(answer(ResumeScan{.scan = id, .hold = HoldName::Door}));
  rig.world.stage.interlock_open = false;
  EXPECT_TRUE(answer(ResumeScan{.scan = id, .hold = HoldName::Door}));
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
}

TEST_F(ScanTurns, AFullDiskHoldsTheScanBeforeACommitFails) {
  const ScanId id = submit();
  until_item();

  rig.tell_disk(50 * 1024 * 1024);
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_THAT(answer(ResumeScan{.scan = id}).error().seen, HasSubstr("50.0 MiB free"));
  rig.tell_disk(110 * 1024 * 1024);
  EXPECT_FALSE(answer(ResumeScan{.scan = id})) << "room again from 125 MiB on";
  rig.tell_disk(126 * 1024 * 1024);
  EXPECT_TRUE(answer(ResumeScan{.scan = id}));
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
}

TEST_F(ScanTurns, TheRestIsMeasuredInANewOrderToANewTarget) {
  const ScanId id = submit({}, {10, 20, 40, 60});
  until_item();
  const std::int64_t first = rig.count("SELECT point_index FROM item");

  ASSERT_TRUE(answer(ChangeScan{.scan = id, .target_snr = 20.0, .order = RestOrder::Reversed, .reason = "hurry"}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(rig.info(id).policy.target_snr, 20.0);
  EXPECT_EQ(rig.info(id).counts.accepted, 8);
  EXPECT_EQ(rig.count("SELECT rank FROM point WHERE point_index = " + std::to_string(first)), 0);
  const auto changed = std::find_if(rig.events.begin(), rig.events.end(),
                                    [](const EventRecord& event) { return event.kind == "scan-changed"; });
  ASSERT_NE(changed, rig.events.end());
  EXPECT_THAT(changed->json, HasSubstr(R"("target_snr":{"from":300.0,"to":20.0})"));
  EXPECT_EQ(rig.count("SELECT count(*) FROM audit WHERE action = 'change' AND who = 'uid:1000' AND detail LIKE "
                      "'%hurry%'"),
            1);
}

TEST_F(ScanTurns, TheRestGoesInTheOrderThatASearchHasFoundForIt) {
  const ScanId id = submit({}, {10, 20, 40, 60});
  until_item();

  ASSERT_TRUE(answer(ChangeScan{.scan = id, .order = RestOrder::Fastest, .fastest = {2, 3, 1}}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  const std::int64_t first = rig.count("SELECT point_index FROM point WHERE rank = 0");
  std::vector<std::int64_t> found{2, 3, 1};
  std::erase(found, first);
  for (std::size_t k = 0; k + 1 < found.size(); ++k) {
    EXPECT_LT(rig.count("SELECT rank FROM point WHERE point_index = " + std::to_string(found[k])),
              rig.count("SELECT rank FROM point WHERE point_index = " + std::to_string(found[k + 1])));
  }
}

TEST_F(ScanTurns, AStageThatLostPowerAndIsBackEndsItsHoldWhereThePlanResumes) {
  const ScanId id = submit();
  until_item();
  rig.watch_for(std::chrono::seconds(1));  // its boot counter is known
  ++rig.world.stage.boot_counter;
  rig.world.stage.homed = false;
  rig.world.move_error = [](const MoveTo&) { return Error{.code = ErrorCode::PositionLost, .device = "stage"}; };
  rig.run_to_rest();
  ASSERT_EQ(rig.state_of(id), ScanState::Holding);
  ASSERT_EQ(holds(), std::vector<HoldName>{HoldName::Device});

  rig.world.move_error = [](const MoveTo&) { return std::nullopt; };
  rig.watch_for(std::chrono::seconds(5));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_TRUE(rig.world.stage.homed);
  EXPECT_EQ(rig.count("SELECT count(*) FROM hold WHERE name = 'device' AND cleared_by = 'goniod'"), 1);
}

TEST_F(ScanTurns, AStageThatLostPowerWaitsForTheOperatorWhereThePlanHolds) {
  NewScan scan = test::new_scan(test::bench_plan({30}, {10, 20, 60}, {90}));
  scan.policy.on_restart = api::OnRestart::Hold;
  const ScanId id = answer(SubmitScan{std::move(scan)})->scan;
  until_item();
  rig.watch_for(std::chrono::seconds(1));
  ++rig.world.stage.boot_counter;
  rig.world.stage.homed = false;
  rig.world.move_error = [](const MoveTo&) { return Error{.code = ErrorCode::PositionLost, .device = "stage"}; };
  rig.run_to_rest();

  rig.world.move_error = [](const MoveTo&) { return std::nullopt; };
  rig.watch_for(std::chrono::seconds(60));
  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  ASSERT_TRUE(answer(ResumeScan{.scan = id}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_TRUE(rig.world.stage.homed);
}

TEST_F(ScanTurns, ALongerTimeBringsLongerExposuresWithADarkBeforeThem) {
  rig.world.rate_dn_per_s = [](double, bool) { return 2e3; };
  NewScan scan = test::new_scan(test::bench_plan({30}, {10, 20, 60}, {90}));
  scan.policy.max_time = std::chrono::milliseconds(8);
  const ScanId id = answer(SubmitScan{std::move(scan)})->scan;
  until_item();

  ASSERT_TRUE(answer(ChangeScan{.scan = id, .max_time = std::chrono::seconds(2)}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_GT(rig.count("SELECT max(exposure_ns) FROM reading WHERE attempt_id > 0 AND used = 1"), 8'000'000);
  EXPECT_EQ(rig.count("SELECT count(*) FROM (SELECT DISTINCT exposure_ns e FROM reading WHERE attempt_id > 0 AND used "
                      "= 1) WHERE (SELECT count(DISTINCT visit_id) FROM reading WHERE visit_id > 0 AND exposure_ns = "
                      "e) < 2"),
            0)
      << "each exposure has its dark before and after";
}

TEST_F(ScanTurns, AnExposureInUseCannotBeTakenAway) {
  const ScanId id = submit();
  until_item();

  const auto changed = answer(ChangeScan{.scan = id, .max_time = std::chrono::microseconds(1)});

  ASSERT_FALSE(changed);
  EXPECT_EQ(changed.error().code, ErrorCode::OutOfLimits);
  EXPECT_THAT(changed.error().limit, HasSubstr("the longest exposure in use"));
}

// ---- with rules in the instrument's file ----

Instrument with_rules() {
  Instrument instrument = test::bench_instrument();
  instrument.holds = {
      .lamp = std::chrono::seconds(30), .door = std::chrono::seconds(10), .disk = std::chrono::seconds(5)};
  instrument.lamp.before_shutter = true;
  return instrument;
}

class ScanTurnsWithRules : public ScanTurns {
 protected:
  ScanTurnsWithRules() : ScanTurns(with_rules()) {}
};

TEST_F(ScanTurnsWithRules, AHoldEndsByItselfWhenItsCauseWasGoneForLongEnough) {
  const ScanId id = submit();
  until_item();
  rig.world.stage.interlock_open = true;
  rig.run_to_rest();
  rig.watch_for(std::chrono::seconds(60));
  EXPECT_EQ(rig.state_of(id), ScanState::Holding);

  rig.world.stage.interlock_open = false;
  rig.watch_for(std::chrono::seconds(9));
  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  rig.watch_for(std::chrono::seconds(3));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(rig.count("SELECT count(*) FROM hold WHERE name = 'door' AND cleared_by = 'goniod'"), 1);
}

TEST_F(ScanTurnsWithRules, TwoHoldsEndOnlyWhenBothAreGone) {
  const ScanId id = submit();
  until_item();
  rig.world.stage.interlock_open = true;
  rig.run_to_rest();
  ASSERT_TRUE(answer(PauseScan{.scan = id}));
  rig.world.stage.interlock_open = false;

  rig.watch_for(std::chrono::seconds(20));
  EXPECT_EQ(holds(), std::vector<HoldName>{HoldName::Operator});
  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  ASSERT_TRUE(answer(ResumeScan{.scan = id}));
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
}

TEST_F(ScanTurnsWithRules, ALampThatComesAndGoesEndsItsHoldABoundedNumberOfTimes) {
  const ScanId id = submit();
  until_item();
  rig.world.monitor = 0.01;
  rig.run_to_rest();
  for (int round = 0; round < 15; ++round) {
    rig.world.monitor = 1.0;
    rig.watch_for(std::chrono::seconds(31));  // the hold may end now ...
    rig.world.monitor = 0.01;                 // ... and the lamp goes out before an item is measured
    rig.run_to_rest();
  }

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_LE(rig.count("SELECT count(*) FROM hold WHERE name = 'lamp' AND cleared_by = 'goniod'"), 11);
}

// ---- the lamp's warm-up ----

Instrument with_warm_up() {
  Instrument instrument = test::bench_instrument();
  instrument.lamp.warm_up = LampWarmUp{.slope_per_s = 0.01 / 60.0, .over = minutes(2), .at_most = minutes(20)};
  return instrument;
}

class ScanTurnsWarmUp : public ScanTurns {
 protected:
  ScanTurnsWarmUp() : ScanTurns(with_warm_up()) {}
};

TEST_F(ScanTurnsWarmUp, AScanWaitsUntilTheLampIsWarmAndTheNextDoesNot) {
  const Instant at_first = rig.clock().now();
  const ScanId first = submit();
  ASSERT_TRUE(rig.run_until([&] { return rig.status().warm_up.has_value(); }));
  ASSERT_TRUE(rig.run_until([&] { return rig.status().warm_up->at_least < minutes(1); }));
  EXPECT_EQ(rig.status().doing, "waiting for the lamp to be warm");
  EXPECT_EQ(rig.world.stage.source_shutter, stage::ShutterState::Open);
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(first), ScanState::Done);
  EXPECT_GT(rig.clock().now() - at_first, minutes(2));
  const Instant begin = rig.clock().now();
  const ScanId second = submit();
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(second), ScanState::Done);
  EXPECT_LT(rig.clock().now() - begin, minutes(2));
}

TEST_F(ScanTurnsWarmUp, AfterARestartItIsSeenToAnew) {
  const ScanId id = submit();
  until_item();

  rig.kill();
  rig.start();

  ASSERT_TRUE(rig.run_until([&] { return rig.status().warm_up.has_value(); }));
  EXPECT_EQ(rig.status().warm_up->at_least, minutes(2));
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
}

TEST_F(ScanTurnsWarmUp, ALampThatDoesNotGetWarmHolds) {
  const ScanId id = submit();
  const Instant begin = rig.clock().now();

  // Two per cent a minute, for ever.
  rig.run_until([&] {
    rig.world.monitor = 1.0 + 0.02 / 60.0 * in_seconds(rig.clock().now() - begin);
    return rig.state_of(id) == ScanState::Holding;
  });
  rig.run_to_rest();

  EXPECT_EQ(holds(), std::vector<HoldName>{HoldName::Lamp});
  EXPECT_THAT(rig.status().active->holds[0].reason, HasSubstr("the lamp is not warm after 12"));
  rig.world.monitor = 1.5;
  ASSERT_TRUE(answer(ResumeScan{.scan = id}));
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
}

}  // namespace
}  // namespace gonio::daemon
