// A stage whose daemon has died must not run on: it stops by itself, and keeps what it knows.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

// Half the speed of life: 70 deg of theta_i take 8 s, the heartbeat is missed after 2 s of wall time.
const SceneOptions kSlow{.time_scale = 0.5};
constexpr double kTarget = 70.0;
constexpr double kWellOnItsWay = 2.0;

class Heartbeat : public testing::Test {
 protected:
  Heartbeat() : bench_(kSlow) { bench_.bring_up_daemon(); }

  SeenAxis arm() const { return bench_.simulator().stage().axes.at("theta_i"); }

  bool arm_is_on_its_way() const {
    const SeenAxis seen = arm();
    return seen.moving && std::abs(seen.target - kTarget) < 0.01 && seen.position > kWellOnItsWay;
  }

  Bench bench_;
};

TEST_F(Heartbeat, StopsAStageWhoseDaemonIsKilledInMidMove) {
  const long scan = bench_.submit(plan_text({.theta_i_deg = "[70]", .theta_r_deg = "[0]", .phi_r_deg = "[0]"}));
  ASSERT_TRUE(eventually([&] { return arm_is_on_its_way(); }, kStepDeadline)) << bench_.log();

  bench_.daemon().kill();
  ASSERT_TRUE(eventually([&] { return !bench_.simulator().stage().moving; }, kStepDeadline));

  const SeenStage stage = bench_.simulator().stage();
  EXPECT_LT(stage.axes.at("theta_i").position, kTarget - 1.0) << "it must not have gone on to its target";
  EXPECT_TRUE(stage.heartbeat_tripped);
  EXPECT_TRUE(stage.homed) << "a missed heartbeat does not cost the home position";
  const SeenExposures before = bench_.simulator().exposures();

  bench_.bring_up_daemon();

  EXPECT_EQ(bench_.wait_for_state(scan, {"done", "failed", "aborted"}), "done") << bench_.log();
  EXPECT_GT(bench_.simulator().exposures().total, before.total);
  EXPECT_EQ(bench_.scan(scan).at("accepted"), 2);
  EXPECT_EQ(bench_.simulator().stage().boot_counter, stage.boot_counter);
}

TEST_F(Heartbeat, IsFedWhileTheDaemonLivesHoweverLongAMoveTakes) {
  bench_.home();

  const HttpAnswer answer = bench_.daemon().post("stage/move", R"({"theta_i_deg":70.0})");

  EXPECT_EQ(answer.status / 100, 2) << answer.body << bench_.log();
  ASSERT_TRUE(eventually([&] { return !arm().moving && arm().position > kTarget - 0.1; }, kStepDeadline));
  EXPECT_FALSE(bench_.simulator().stage().heartbeat_tripped);
}

}  // namespace
}  // namespace gonio::test
