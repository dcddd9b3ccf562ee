// Somebody sets the clock while a scan runs: it is told, and no interval changes.
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <vector>

#include "tests/daemon/sequencer/scan_rig.h"

namespace gonio::daemon {
namespace {

using test::bench_plan;
using test::ScanRig;
using namespace std::chrono_literals;

api::Plan plan_of_minutes() {
  api::Plan plan = bench_plan({30, 50}, {10, 20, 40, 60}, {90, 150});
  plan.target_snr = 200;
  plan.max_time = 2ms;
  plan.dark_every = 20s;
  return plan;
}

struct Timing {
  std::int64_t items = 0;
  std::int64_t darks = 0;
  std::int64_t last_boottime_ns = 0;
  double idle_and_work_s = 0.0;
};

Timing timing_of(ScanRig& rig) {
  return {.items = rig.count("SELECT count(*) FROM item WHERE outcome = 'accepted'"),
          .darks = rig.count("SELECT count(*) FROM visit WHERE kind = 'dark'"),
          .last_boottime_ns = rig.count("SELECT max(boottime_ns) FROM reading"),
          .idle_and_work_s = in_seconds(rig.clock().now().time_since_epoch())};
}

// A scan while whose items are accepted the clock is set so often, each time by the next of `steps`.
Timing scan_with(ScanRig& rig, const std::vector<Duration>& steps) {
  const ScanId id = rig.submit(plan_of_minutes());
  std::int64_t accepted = 0;
  for (const Duration step : steps) {
    accepted += 4;
    rig.run_until([&] { return rig.count("SELECT count(*) FROM item") >= accepted; });
    rig.wall_clock().set_ahead_by(step);
  }
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  return timing_of(rig);
}

std::vector<double> told_steps_s(const ScanRig& rig) {
  std::vector<double> steps;
  for (const EventRecord& event : rig.events) {
    if (event.kind == "clock-stepped") steps.push_back(nlohmann::json::parse(event.json).at("step_s").get<double>());
  }
  return steps;
}

TEST(ClockStep, IsAnEventAndChangesNoInterval) {
  ScanRig steady;
  const Timing undisturbed = scan_with(steady, {});
  ScanRig rig;
  const Timing stepped = scan_with(rig, {1h, -3h, 2s, -24h});

  const std::vector<double> told = told_steps_s(rig);
  ASSERT_EQ(told.size(), 4U);
  EXPECT_DOUBLE_EQ(told[0], 3600.0);
  EXPECT_DOUBLE_EQ(told[1], -10800.0);
  EXPECT_DOUBLE_EQ(told[2], 2.0);
  EXPECT_DOUBLE_EQ(told[3], -86400.0);
  EXPECT_EQ(stepped.items, undisturbed.items);
  EXPECT_EQ(stepped.darks, undisturbed.darks);
  EXPECT_GT(stepped.darks, 2) << "the plan is long enough for darks between";
  EXPECT_EQ(stepped.last_boottime_ns, undisturbed.last_boottime_ns);
  EXPECT_DOUBLE_EQ(stepped.idle_and_work_s, undisturbed.idle_and_work_s);
  EXPECT_EQ(rig.count("SELECT count(*) FROM event"), rig.count("SELECT max(number) FROM event"));
  EXPECT_EQ(rig.count("SELECT count(*) FROM (SELECT boottime_ns, lag(boottime_ns) OVER (ORDER BY reading_id) AS before "
                      "FROM reading) WHERE boottime_ns < before"),
            0)
      << "readings are in their order";
}

TEST(ClockStep, BackwardsWhileTheDaemonIsDownLosesNoOrderWithinABoot) {
  ScanRig rig;
  const ScanId id = rig.submit(plan_of_minutes());
  rig.run_until([&] { return rig.count("SELECT count(*) FROM item") >= 6; });
  rig.command(PauseScan{.scan = id, .reason = "lunch"});
  rig.run_to_rest();
  ASSERT_EQ(rig.status().active->holds.size(), 1U);

  rig.kill();
  rig.wall_clock().set_ahead_by(-2h);
  rig.start();
  rig.run_to_rest();

  ASSERT_EQ(rig.status().active->holds.size(), 1U);
  EXPECT_LE(rig.status().active->holds[0].since, rig.clock().now()) << "a hold cannot begin in the future";
  rig.command(ResumeScan{id});
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(rig.count("SELECT count(*) FROM item WHERE outcome = 'accepted'"), 32);
  EXPECT_EQ(rig.count("SELECT count(*) FROM (SELECT boottime_ns, lag(boottime_ns) OVER (ORDER BY reading_id) AS before "
                      "FROM reading) WHERE boottime_ns < before"),
            0);
}

}  // namespace
}  // namespace gonio::daemon
