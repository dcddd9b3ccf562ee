// An instrument that lost its power and has forgotten its home: what the plan's policy says is done about it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

const SceneOptions kScene{.time_scale = 20.0};
const PlanOptions kPlan{.theta_i_deg = "[15, 45]", .theta_r_deg = "[10, 40, 70]", .phi_r_deg = "[90, 180]"};
constexpr long kItems = 2 * 2 * 6;

std::string plan_with_policy(const std::string& policy) {
  std::string text = plan_text(kPlan);
  const std::string resume = "policy = \"resume\"";
  return text.replace(text.find(resume), resume.size(), "policy = \"" + policy + "\"");
}

class Recovery : public testing::Test {
 protected:
  // A scan that has accepted something.
  void begin(const std::string& policy) {
    bench_.bring_up_daemon();
    scan_ = bench_.submit(plan_with_policy(policy));
    EventReader events(bench_.daemon().port(), 0);
    EXPECT_TRUE(events.wait_for([](const auto& seen) { return count_of(seen, "item-accepted") >= 3; }, kStepDeadline))
        << bench_.log();
  }

  void lose_all_power() {
    bench_.simulator().kill();
    bench_.daemon().kill();
    bench_.simulator().restart();
    bench_.bring_up_daemon();
  }

  // It stands where it was left, and does not know where that is.
  void expect_that_nothing_has_moved() const {
    const SeenStage stage = bench_.simulator().stage();
    EXPECT_EQ(stage.boot_counter, 2);
    EXPECT_FALSE(stage.homed);
    EXPECT_EQ(stage.motion_commands, 0);
  }

  void expect_completion() {
    ASSERT_EQ(bench_.wait_for_state(scan_, {"done", "failed", "aborted", "holding"}), "done")
        << bench_.holds_of(scan_) << bench_.log();
    EXPECT_TRUE(bench_.simulator().stage().homed);
    EXPECT_EQ(bench_.simulator().stage().boot_counter, 2);
    EXPECT_EQ(bench_.scan(scan_).at("accepted"), kItems);
    const std::vector<ServerEvent> events = all_events(bench_, bench_.daemon().port());
    EXPECT_TRUE(is_gapless_from(1, events));
    const std::vector<std::string> items = accepted_items(events);
    EXPECT_EQ(items.size(), static_cast<std::size_t>(kItems));
    EXPECT_EQ(std::set<std::string>(items.begin(), items.end()).size(), items.size());
  }

  Bench bench_{kScene};
  long scan_ = 0;
};

TEST_F(Recovery, OfAllHomesTheStageAndGoesOnWhenThePlanSaysResume) {
  begin("resume");
  lose_all_power();
  expect_completion();
}

TEST_F(Recovery, OfAllWaitsForTheOperatorWhenThePlanSaysHold) {
  begin("hold");
  lose_all_power();

  ASSERT_EQ(bench_.wait_for_state(scan_, {"holding", "done"}), "holding") << bench_.log();
  EXPECT_NE(bench_.holds_of(scan_).find("restart: "), std::string::npos) << bench_.holds_of(scan_);
  expect_that_nothing_has_moved();

  bench_.reset_and_resume(scan_);
  expect_completion();
}

TEST_F(Recovery, OfTheInstrumentAloneHomesItAndGoesOnWhenThePlanSaysResume) {
  begin("resume");
  bench_.simulator().kill();
  bench_.simulator().restart();

  ASSERT_EQ(bench_.wait_for_state(scan_, {"done", "failed", "aborted"}), "done") << bench_.log();

  expect_completion();
  const std::vector<ServerEvent> events = all_events(bench_, bench_.daemon().port());
  EXPECT_GE(count_of(events, "hold-added"), 1) << "somebody may want to know why";
}

TEST_F(Recovery, OfTheInstrumentAloneHoldsWhenThePlanSaysSoAndTheResumeHomesIt) {
  begin("hold");
  bench_.simulator().kill();
  bench_.simulator().restart();

  ASSERT_EQ(bench_.wait_for_state(scan_, {"holding", "done"}), "holding") << bench_.log();
  EXPECT_NE(bench_.holds_of(scan_).find("device: "), std::string::npos) << bench_.holds_of(scan_);
  expect_that_nothing_has_moved();

  bench_.reset_and_resume(scan_);
  expect_completion();
}

}  // namespace
}  // namespace gonio::test
