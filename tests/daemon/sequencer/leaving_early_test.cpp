// The arms leave for the next item when the light of the last frame is integrated, and come back when it was not the
// last.
#include <gtest/gtest.h>

#include "tests/daemon/sequencer/scan_rig.h"

namespace gonio::daemon {
namespace {

using test::bench_plan;
using test::ScanRig;

class LeavingEarly : public testing::Test {
 protected:
  LeavingEarly() { rig.world.frame_takes = std::chrono::milliseconds(300); }

  static api::Plan plan_of_eight() {
    api::Plan plan = bench_plan({30}, {10, 15, 20, 35, 40, 45, 50, 60}, {90});
    plan.target_snr = 200;
    plan.max_time = std::chrono::milliseconds(20);
    return plan;
  }
  std::int64_t accepted() { return rig.count("SELECT count(*) FROM item WHERE outcome = 'accepted'"); }
  bool run_to_a_move_beside_a_frame() {
    return rig.run_until([&] { return rig.world.moves_beside_a_frame > 0; });
  }
  // Encoders of used readings that do not stand at their point.
  std::int64_t readings_elsewhere() {
    return rig.count(
        "SELECT count(*) FROM reading JOIN attempt USING (attempt_id) JOIN point USING (scan_id, point_index) "
        "WHERE abs(open_theta_r_counts - 10000 * theta_r_deg) > 100 OR abs(close_theta_r_counts - 10000 * theta_r_deg) "
        "> 100 OR (target = 'reference') <> (open_carriage_counts > 600000)");
  }

  ScanRig rig;
};

TEST_F(LeavingEarly, TheFrameIsReadWhileTheNextMoveRuns) {
  const ScanId id = rig.submit(plan_of_eight());

  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(accepted(), 16);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt"), 16);
  EXPECT_GE(rig.world.moves_beside_a_frame, 12) << "all but the first of each target, and the last";
  EXPECT_EQ(readings_elsewhere(), 0);
}

TEST_F(LeavingEarly, AFrameThatTakesLongCostsNothingWhileTheArmsMove) {
  const ScanId id = rig.submit(plan_of_eight());

  rig.run_to_rest();

  // 16 items and 8 rungs' darks wait for their frames in full; of the rest, moves of 0.5 s and more cover 0.3 s.
  const TimeParts spent = rig.info(id).spent;
  const double items_read_s =
      1e-9 * static_cast<double>(rig.count("SELECT sum(read_ns) FROM attempt WHERE number = 1"));
  EXPECT_LT(items_read_s, 4 * 0.3) << "the first of each target, and the last";
  EXPECT_GT(spent.move, std::chrono::seconds(5));
}

TEST_F(LeavingEarly, NoLightIsTakenBeforeTheItemBeforeIsCommitted) {
  rig.submit(plan_of_eight());

  while (rig.step()) {
    // `exposures` of this run minus those stored: the item in hand and no other.
    const std::int64_t lit = rig.count("SELECT count(*) FROM reading WHERE attempt_id > 0");
    std::int64_t exposed = 0;
    for (const auto& [item, count] : rig.world.exposed_at) exposed += count;
    ASSERT_LE(exposed - lit, 3) << "an item has three frames at most here";
  }
  EXPECT_EQ(accepted(), 16);
}

TEST_F(LeavingEarly, AFrameThatSaturatedBringsTheArmsBackAndTheItemIsMeasuredInItsPlace) {
  rig.world.rate_dn_per_s = [](double theta_r, bool) { return theta_r > 44.0 && theta_r < 46.0 ? 2e6 : 1e4; };
  const ScanId id = rig.submit(plan_of_eight());

  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(accepted(), 16);
  EXPECT_GE(rig.count("SELECT count(*) FROM reading WHERE saturated > 0 AND attempt_id > 0"), 1);
  EXPECT_EQ(readings_elsewhere(), 0) << "all frames of an item are of one place";
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt"), 16) << "it is one attempt";
  EXPECT_GT(rig.info(id).spent.idle.device, std::chrono::milliseconds(500)) << "the ways there and back";
}

TEST_F(LeavingEarly, AFrameThatWasTooDarkBringsTheArmsBack) {
  rig.world.rate_dn_per_s = [](double theta_r, bool) { return theta_r > 44.0 && theta_r < 46.0 ? 4e3 : 3e5; };
  rig.submit(plan_of_eight());

  rig.run_to_rest();

  EXPECT_EQ(accepted(), 16);
  EXPECT_EQ(readings_elsewhere(), 0);
  EXPECT_GT(rig.count("SELECT count(*) FROM reading WHERE attempt_id > 0"), 16);
}

TEST_F(LeavingEarly, AFrameThatIsLostBringsTheArmsBackForAnotherTry) {
  rig.submit(plan_of_eight());
  ASSERT_TRUE(run_to_a_move_beside_a_frame());
  bool has_failed = false;
  rig.world.frame_error = [&has_failed]() -> std::optional<Error> {
    if (std::exchange(has_failed, true)) return std::nullopt;
    return Error{.code = ErrorCode::IncompleteData, .device = "detector", .tried = "fetch the frame"};
  };

  rig.run_to_rest();

  EXPECT_EQ(accepted(), 16);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE outcome = 'failed'"), 1);
  EXPECT_EQ(readings_elsewhere(), 0);
}

TEST_F(LeavingEarly, AMoveThatFailsAheadOfItsTurnIsTheNextItemsFailure) {
  const ScanId id = rig.submit(plan_of_eight());
  ASSERT_TRUE(run_to_a_move_beside_a_frame());
  int failures = 0;
  rig.world.move_error = [&](const MoveTo&) -> std::optional<Error> {
    if (rig.clock().now() >= rig.world.frame_due || failures > 0) return std::nullopt;
    ++failures;
    return Error{.code = ErrorCode::MotionLate, .device = "stage", .tried = "move"};
  };

  rig.run_to_rest();

  EXPECT_EQ(failures, 1);
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(accepted(), 16);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE outcome = 'failed'"), 1);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE outcome = 'failed' AND number > 1"), 0);
}

TEST_F(LeavingEarly, APauseMeanwhileKeepsTheItemAndTakesNoMoreLight) {
  const ScanId id = rig.submit(plan_of_eight());
  ASSERT_TRUE(run_to_a_move_beside_a_frame());
  const std::int64_t before = accepted();
  const int exposures = rig.world.exposures;

  rig.command(PauseScan{.scan = id, .reason = "lunch"});
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_EQ(accepted(), before + 1) << "its light was there";
  EXPECT_EQ(rig.world.exposures, exposures);
  rig.command(ResumeScan{id});
  rig.run_to_rest();
  EXPECT_EQ(accepted(), 16);
}

TEST_F(LeavingEarly, AStopMeanwhileDropsBothAndNothingIsMeasuredTwiceIntoTheStore) {
  const ScanId id = rig.submit(plan_of_eight());
  ASSERT_TRUE(run_to_a_move_beside_a_frame());

  rig.stop();
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  rig.command(ClearStage{});
  rig.run_to_rest();
  rig.command(ResumeScan{id});
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(accepted(), 16);
  EXPECT_EQ(readings_elsewhere(), 0);
}

TEST_F(LeavingEarly, ASkipMeanwhileSkipsTheItemWhoseFrameIsReadAndNotTheNext) {
  const ScanId id = rig.submit(plan_of_eight());
  ASSERT_TRUE(run_to_a_move_beside_a_frame());
  const auto in_hand = rig.status().active->in_hand;
  ASSERT_TRUE(in_hand);

  rig.command(SkipItemInHand{.scan = id});
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(accepted(), 14) << "its partner goes with it";
  EXPECT_EQ(rig.count("SELECT count(DISTINCT point_index) FROM item WHERE outcome = 'skipped'"), 1);
  EXPECT_EQ(rig.count("SELECT min(point_index) FROM item WHERE outcome = 'skipped'"), in_hand->point);
}

TEST_F(LeavingEarly, AllTimeOfAScanIsInSomePart) {
  const ScanId id = rig.submit(plan_of_eight());
  rig.run_until([&] { return rig.state_of(id) == ScanState::Running; });
  const Instant began = rig.clock().now();

  rig.run_until([&] { return rig.state_of(id) == ScanState::Finishing; });

  // Of what came before `running` its preparation is counted, of what comes after the last item nothing yet.
  const double elapsed = in_seconds(rig.clock().now() - began);
  EXPECT_NEAR(in_seconds(rig.info(id).spent.total()), elapsed, 0.02 * elapsed);
}

}  // namespace
}  // namespace gonio::daemon
