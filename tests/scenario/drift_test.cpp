// A lamp that drifts and steps, and a monitor that does not see all of it, in whole programs: what lies between two
// visits of the standard that differ is measured again, and each item counts once in the end.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"
#include "tests/scenario/store_copy.h"

namespace gonio::test {
namespace {

using nlohmann::json;

// 2 % an hour that the monitor sees. What it does not see wanders by 6 % within two minutes of the scene, which are
// three seconds of the wall clock: more than the limit between any two visits, however fast the machine is.
const SceneOptions kDriftingScene{
    .time_scale = 40.0,
    .more =
        "[source]\npower = 1.0\ndrift_per_hour = -0.02\nmonitor_noise = 0.002\nmonitor_rate_hz = 10000.0\n"
        "u_after_monitor = 0.06\ncorrelation_s = 120.0\nu_reproducibility = 0.0005\n"};
const PlanOptions kVisitedPlan{.theta_i_deg = "[15, 45]",
                               .theta_r_deg = "[10, 20, 30, 60, 70]",
                               .phi_r_deg = "[90, 135, 180]",
                               .target_snr = 500.0,
                               .visits = "reference_s = 1.5\ndrift_limit = 0.005\ndrift_rounds = 2\n"};

class DriftingLamp : public testing::Test {
 protected:
  void measure() {
    bench_.bring_up_daemon();
    scan_ = bench_.submit(plan_text(kVisitedPlan));
    EventReader events(bench_.daemon().port(), 0);
    ASSERT_TRUE(events.wait_for([](const auto& seen) { return count_of(seen, "item-accepted") >= 10; }, kStepDeadline))
        << bench_.log();
    (void)bench_.simulator().fault("lamp-step", R"("by_percent":3)");
    ASSERT_EQ(bench_.wait_for_state(scan_, {"done", "failed", "aborted", "holding"}), "done")
        << bench_.holds_of(scan_) << bench_.log();
  }

  Bench bench_{kDriftingScene};
  long scan_ = 0;
};

TEST_F(DriftingLamp, HasTheStretchBetweenTwoVisitsMeasuredAgainAndEachItemInForceOnce) {
  measure();

  const json report = bench_.scan(scan_);
  EXPECT_GE(report.at("reference_visits"), 3);
  EXPECT_GT(report.at("measured_again"), 0);
  EXPECT_GT(report.at("largest_drift"), 0.005);
  EXPECT_EQ(report.at("accepted"), report.at("items"));
  EXPECT_GT(report.at("attempts"), report.at("items")) << "the first rounds are kept beside the last";
  const std::vector<ServerEvent> events = all_events(bench_, bench_.daemon().port());
  EXPECT_TRUE(is_gapless_from(1, events));
  EXPECT_GE(count_of(events, "items-reopened"), 1);
  const std::vector<std::string> told = accepted_items(events);
  EXPECT_EQ(std::ssize(std::set<std::string>(told.begin(), told.end())), report.at("items"));

  bench_.daemon().kill();
  const StoreCopy store(bench_.files().store, bench_.folder());
  EXPECT_EQ(store.integrity(), "ok");
  EXPECT_EQ(std::ssize(store.accepted_items()), report.at("items")) << "one decision in force for each";
  EXPECT_EQ(store.count("decided_item WHERE outcome = 'accepted'"), report.at("items"));
  EXPECT_GT(store.count("item"), report.at("items").get<long>());
}

TEST_F(DriftingLamp, LeavesTheBrdfWithinItsUncertainty) {
  measure();

  EXPECT_GT(expect_agreement(bench_.measured_and_true(scan_)), 20);
}

}  // namespace
}  // namespace gonio::test
