// STOP halts all motion, from any client, in every state; nothing moves again until an operator says so.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

// Slow enough that a scan is still moving when a client has seen that it moves.
const SceneOptions kScene{.time_scale = 4.0};
const PlanOptions kPlan{
    .theta_i_deg = "[10, 70]", .theta_r_deg = "[0, 50]", .phi_r_deg = "[180]", .strategy = "as-written"};
constexpr long kItems = 8;

class Stop : public testing::Test {
 protected:
  Stop() : bench_(kScene) { bench_.bring_up_daemon(); }

  bool is_moving_an_arm() const {
    const SeenStage stage = bench_.simulator().stage();
    return stage.homed && stage.axes.at("theta_i").moving;
  }

  // A scan that has accepted something and moves.
  long scan_in_mid_move(EventReader& events) {
    const long scan = bench_.submit(plan_text(kPlan));
    EXPECT_TRUE(events.wait_for([](const auto& seen) { return count_of(seen, "item-accepted") > 0; }, kStepDeadline))
        << bench_.log();
    EXPECT_TRUE(eventually([&] { return is_moving_an_arm(); }, kStepDeadline)) << bench_.log();
    return scan;
  }

  // A halted axis brakes, it does not stand at once.
  void expect_it_stands_and_stays() {
    EXPECT_TRUE(eventually([&] { return !bench_.simulator().stage().moving; }, kStepDeadline));
    const SeenStage before = bench_.simulator().stage();
    // Ten answers of the daemon later nothing has changed: the sequencer has had its turns.
    for (int i = 0; i < 10; ++i) (void)bench_.get("status");
    const SeenStage after = bench_.simulator().stage();
    EXPECT_TRUE(after.halted);
    EXPECT_EQ(after.motion_commands, before.motion_commands);
    EXPECT_EQ(after.shutter_commands, before.shutter_commands);
    for (const auto& [name, axis] : after.axes) EXPECT_NEAR(axis.position, before.axes.at(name).position, 0.02) << name;
  }

  void expect_completed_with_each_item_once(long scan, const EventReader& events) {
    EXPECT_EQ(bench_.wait_for_state(scan, {"done", "failed", "aborted"}), "done") << bench_.log();
    EXPECT_EQ(bench_.scan(scan).at("accepted"), kItems);
    const std::vector<std::string> items = accepted_items(all_events(bench_, bench_.daemon().port()));
    EXPECT_EQ(items.size(), static_cast<std::size_t>(kItems));
    EXPECT_EQ(std::set<std::string>(items.begin(), items.end()).size(), items.size());
    EXPECT_TRUE(is_gapless_from(1, events.events()));
  }

  Bench bench_;
};

TEST_F(Stop, HaltsAScanInMidMoveAndKeepsItHalted) {
  EventReader events(bench_.daemon().port(), 0);
  const long scan = scan_in_mid_move(events);

  const HttpAnswer answer = bench_.daemon().post("stop");

  EXPECT_EQ(answer.status, 200) << answer.body;
  EXPECT_TRUE(eventually([&] { return bench_.simulator().stage().halted; }, kStepDeadline));
  EXPECT_EQ(bench_.wait_for_state(scan, {"holding", "done"}), "holding");
  EXPECT_EQ(count_of(all_events(bench_, bench_.daemon().port()), "stop"), 1);
  expect_it_stands_and_stays();
}

TEST_F(Stop, IsOverOnlyAfterAResetAndAResume) {
  EventReader events(bench_.daemon().port(), 0);
  const long scan = scan_in_mid_move(events);
  const Finished stop = bench_.gonioctl({"stop"});
  ASSERT_EQ(stop.exit_code, 0) << stop.errors;
  ASSERT_EQ(bench_.wait_for_state(scan, {"holding", "done"}), "holding");

  const Finished too_early = bench_.gonioctl({"scan", "resume", std::to_string(scan)});

  EXPECT_NE(too_early.exit_code, 0) << "a scan cannot resume on a stage that stands stopped";
  EXPECT_NE(too_early.errors.find("reset"), std::string::npos) << too_early.errors;
  expect_it_stands_and_stays();

  const Finished reset = bench_.gonioctl({"stage", "reset"});
  EXPECT_EQ(reset.exit_code, 0) << reset.errors;
  EXPECT_EQ(bench_.state_of(scan), "holding") << "a reset resumes nothing";
  const Finished resume = bench_.gonioctl({"scan", "resume", std::to_string(scan)});
  EXPECT_EQ(resume.exit_code, 0) << resume.errors << bench_.log();
  expect_completed_with_each_item_once(scan, events);
}

TEST_F(Stop, IsAnsweredWhileAMoveByHandIsUnderWay) {
  bench_.home();
  std::thread mover([&] { (void)bench_.daemon().post("stage/move", R"({"theta_i_deg":80.0})"); });
  EXPECT_TRUE(eventually([&] { return is_moving_an_arm(); }, kStepDeadline)) << bench_.log();

  const HttpAnswer answer = bench_.daemon().post("stop");

  EXPECT_EQ(answer.status, 200) << answer.body;
  EXPECT_TRUE(eventually([&] { return !bench_.simulator().stage().moving; }, kStepDeadline));
  EXPECT_LT(bench_.simulator().stage().axes.at("theta_i").position, 79.0);
  EXPECT_TRUE(bench_.simulator().stage().halted);
  mover.join();
}

}  // namespace
}  // namespace gonio::test
