// A lamp that steps in the middle of a scan, and a daemon that is killed at any instant of it: what is measured again
// is neither lost nor doubled.
#include <gtest/gtest.h>

#include "tests/daemon/sequencer/scan_rig.h"

namespace gonio::daemon {
namespace {

using test::bench_plan;
using test::ScanRig;

constexpr int kPoints = 3;

api::Plan plan_in_a_drift() {
  api::Plan plan = bench_plan({30}, {10, 20, 25}, {90});
  plan.target_snr = 200;
  plan.max_time = std::chrono::milliseconds(2);
  plan.reference_every = std::chrono::seconds(2);
  plan.block = std::chrono::seconds(4);
  return plan;
}

// Steps after the fourth second: some items lie before it, some after it, wherever the kill was.
void let_the_lamp_step(ScanRig& rig) {
  const Instant step = rig.clock().now() + std::chrono::seconds(4);
  rig.world.gain = [step](Instant now) { return now < step ? 1.0 : 0.9; };
}

void expect_each_round_once(ScanRig& rig, ScanId id) {
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  if (rig.status().active && !rig.status().active->holds.empty()) {
    ADD_FAILURE() << rig.status().active->holds[0].reason;
  }
  const std::int64_t reopened = rig.count("SELECT count(*) FROM reopening");
  EXPECT_EQ(rig.count("SELECT count(*) FROM decided_item WHERE outcome = 'accepted'"), 2 * kPoints);
  EXPECT_EQ(rig.count("SELECT count(*) FROM item"), 2 * kPoints + reopened);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE outcome = 'accepted'"), 2 * kPoints + reopened);
  EXPECT_EQ(rig.count("SELECT count(*) FROM event WHERE kind = 'item-accepted'"), 2 * kPoints + reopened);
  EXPECT_EQ(rig.count("SELECT count(*) FROM event WHERE kind = 'items-reopened'"),
            rig.count("SELECT count(DISTINCT visit_id) FROM reopening"));
  EXPECT_EQ(rig.count("SELECT total(json_extract(json, '$.items')) FROM event WHERE kind = 'items-reopened'"),
            reopened);
  EXPECT_EQ(rig.count("SELECT count(*) FROM event WHERE kind = 'reference-visit'"),
            rig.count("SELECT count(*) FROM visit WHERE kind = 'reference'"));
  EXPECT_EQ(rig.count("SELECT count(*) FROM event"), rig.count("SELECT max(number) FROM event"));
}

TEST(VisitKill, KilledAtEveryOtherStepOfAScanThatMeasuresAgainItLosesAndDoublesNothing) {
  int steps = 0;
  {
    ScanRig rig;
    let_the_lamp_step(rig);
    const ScanId id = rig.submit(plan_in_a_drift());
    while (rig.step()) ++steps;
    expect_each_round_once(rig, id);
    ASSERT_GT(rig.count("SELECT count(*) FROM reopening"), 0) << "the step has to be seen";
  }
  ASSERT_GT(steps, 50);

  std::int64_t reopened_before_a_kill = 0;
  for (int kill_after = 1; kill_after <= steps; kill_after += 2) {
    SCOPED_TRACE("killed after step " + std::to_string(kill_after));
    ScanRig rig;
    let_the_lamp_step(rig);
    const ScanId id = rig.submit(plan_in_a_drift());
    for (int k = 0; k < kill_after; ++k) rig.step();
    const std::int64_t reopened = rig.count("SELECT count(*) FROM reopening");
    const std::int64_t open_rounds = rig.count(
        "SELECT count(*) FROM reopening r WHERE NOT EXISTS (SELECT 1 FROM item i WHERE i.point_index = "
        "r.point_index AND i.target = r.target AND i.round = r.round + 1)");
    if (open_rounds > 0) ++reopened_before_a_kill;

    rig.kill();
    rig.start();
    rig.run_to_rest();

    expect_each_round_once(rig, id);
    EXPECT_GE(rig.count("SELECT count(*) FROM reopening"), reopened);
    if (testing::Test::HasFailure()) return;
  }
  EXPECT_GT(reopened_before_a_kill, 0) << "no kill came while a round was open";
}

}  // namespace
}  // namespace gonio::daemon
