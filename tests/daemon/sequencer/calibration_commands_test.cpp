// What counts as calibration, and scans computed anew, pass through the sequencer only to be durable in their order.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/daemon/sequencer/scan_rig.h"

namespace gonio::daemon {
namespace {

using test::ScanRig;

TEST(CalibrationCommands, ARecomputeIsToldAsAnEventWhileAScanRuns) {
  ScanRig rig;
  const ScanId scan = rig.submit(test::bench_plan({30}, {10, 40}, {90}));
  ASSERT_TRUE(rig.run_until([&] { return rig.state_of(scan) == ScanState::Running; }));

  const CommandId asked = rig.command(RecomputeScan{.scan = scan, .versions = {{4, 7}}});
  ASSERT_TRUE(rig.run_until([&] { return rig.reply_to(asked) != nullptr; }));

  EXPECT_TRUE(rig.reply_to(asked)->result);
  const auto event = std::ranges::find(rig.events, "recompute-asked", &EventRecord::kind);
  ASSERT_NE(event, rig.events.end());
  EXPECT_EQ(event->scan, scan);
  EXPECT_EQ(event->json, R"({"versions":[4,7]})");
  EXPECT_EQ(rig.count("SELECT count(*) FROM audit WHERE action = 'recompute' AND who = 'uid:1000'"), 1);
  ASSERT_TRUE(rig.run_until([&] { return rig.state_of(scan) == ScanState::Done; })) << "it goes on beside it";
}

}  // namespace
}  // namespace gonio::daemon
