// A device that goes away in mid-scan: the scan holds and says why, accepts nothing meanwhile, and goes on afterwards.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

// Long enough that a fault comes into the middle of it: 24 geometries, none of them in the shadow, on sample and
// reference. The plan would skip an item at its first failure: a lost device must hold all the same.
const SceneOptions kScene{.time_scale = 10.0};
const PlanOptions kPlan{.theta_i_deg = "[15, 30, 45, 60]",
                        .theta_r_deg = "[10, 40, 70]",
                        .phi_r_deg = "[90, 180]",
                        .on_item_error = "skip"};
constexpr long kItems = 2 * 4 * 6;

class DeviceLoss : public testing::Test {
 protected:
  DeviceLoss() : bench_(kScene) {
    bench_.bring_up_daemon();
    scan_ = bench_.submit(plan_text(kPlan));
    EventReader events(bench_.daemon().port(), 0);
    EXPECT_TRUE(events.wait_for([](const auto& seen) { return count_of(seen, "item-accepted") >= 3; }, kStepDeadline))
        << bench_.log();
  }

  void expect_a_hold(const std::string& hold, const std::string& device) {
    ASSERT_EQ(bench_.wait_for_state(scan_, {"holding", "done", "failed"}), "holding") << bench_.log();
    EXPECT_NE(bench_.holds_of(scan_).find(hold + ": "), std::string::npos) << bench_.holds_of(scan_);
    EXPECT_NE(bench_.holds_of(scan_).find(device), std::string::npos) << bench_.holds_of(scan_);
    accepted_at_hold_ = bench_.scan(scan_).at("accepted").get<long>();
    EXPECT_GE(accepted_at_hold_, 3);
    EXPECT_LT(accepted_at_hold_, kItems);
  }

  // What was accepted at the hold is all that is accepted until the operator resumes.
  void expect_nothing_accepted_since() {
    EXPECT_EQ(bench_.scan(scan_).at("accepted"), accepted_at_hold_);
    EXPECT_EQ(bench_.state_of(scan_), "holding");
  }

  void expect_completion() {
    bench_.reset_and_resume(scan_);
    // A hold that comes back while a device is still starting is answered as an operator would.
    std::string state = bench_.wait_for_state(scan_, {"done", "failed", "aborted", "holding"});
    for (int again = 0; again < 20 && state == "holding"; ++again) {
      bench_.reset_and_resume(scan_);
      state = bench_.wait_for_state(scan_, {"done", "failed", "aborted", "holding"});
    }
    ASSERT_EQ(state, "done") << bench_.log();
    const auto report = bench_.scan(scan_);
    EXPECT_EQ(report.at("accepted"), kItems);
    EXPECT_EQ(report.at("skipped"), 0) << "a lost device is no reason to skip a point";
    const std::vector<ServerEvent> events = all_events(bench_, bench_.daemon().port());
    EXPECT_TRUE(is_gapless_from(1, events));
    const std::vector<std::string> items = accepted_items(events);
    EXPECT_EQ(items.size(), static_cast<std::size_t>(kItems));
    EXPECT_EQ(std::set<std::string>(items.begin(), items.end()).size(), items.size());
  }

  Bench bench_;
  long scan_ = 0;
  long accepted_at_hold_ = 0;
};

TEST_F(DeviceLoss, OfTheCameraHoldsTheScanUntilItIsBack) {
  bench_.simulator().silence_camera(true);
  expect_a_hold("device", "detector");
  expect_nothing_accepted_since();

  bench_.simulator().silence_camera(false);
  expect_nothing_accepted_since();
  expect_completion();
}

TEST_F(DeviceLoss, OfTheStagesRepliesHoldsTheScanUntilTheyAreBack) {
  bench_.simulator().silence_stage(true);
  expect_a_hold("device", "stage");
  expect_nothing_accepted_since();

  bench_.simulator().silence_stage(false);
  expect_nothing_accepted_since();
  expect_completion();
}

TEST_F(DeviceLoss, OfTheStagesConnectionHoldsTheScanUntilItIsBack) {
  bench_.simulator().refuse_stage(true);
  expect_a_hold("device", "stage");
  expect_nothing_accepted_since();

  bench_.simulator().refuse_stage(false);
  expect_nothing_accepted_since();
  expect_completion();
}

TEST_F(DeviceLoss, OfAnAxisThatNeverArrivesIsNotTakenForSuccess) {
  bench_.simulator().block_axis("theta_r", true);
  expect_a_hold("device", "theta_r");
  expect_nothing_accepted_since();

  bench_.simulator().block_axis("theta_r", false);
  expect_nothing_accepted_since();
  expect_completion();
}

}  // namespace
}  // namespace gonio::test
