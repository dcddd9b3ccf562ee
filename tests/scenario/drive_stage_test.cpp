// A stage of ready-made drives and a coupler, each with its own unit id: no token, no gate, no epoch on the wire.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

constexpr std::uint64_t kSeed = 7;

class DriveStageScenario : public testing::TestWithParam<const char*> {
 protected:
  DriveStageScenario() : bench_(SceneOptions{.seed = kSeed, .stage_wire = GetParam(), .stage = "drives"}) {
    bench_.bring_up_daemon();
  }

  Bench bench_;
};

TEST_P(DriveStageScenario, MeasuresWhatOnlyTheSimulatorKnows) {
  const long scan = bench_.submit(plan_text({}));
  ASSERT_EQ(bench_.wait_for_state(scan, {"done", "failed", "aborted", "holding"}), "done")
      << bench_.holds_of(scan) << bench_.log();

  const int compared = expect_agreement(bench_.measured_and_true(scan));

  EXPECT_EQ(compared, 8);
  EXPECT_EQ(bench_.scan(scan).at("skipped"), 0);
}

TEST_P(DriveStageScenario, StopsAMoveThatThenCountsAsStopped) {
  const Finished well = bench_.gonioctl({"doctor", "--move"});

  EXPECT_EQ(well.exit_code, 0) << well.output << well.errors << bench_.log();
  EXPECT_NE(well.output.find("STOP halts a move: "), std::string::npos) << well.output;
  EXPECT_EQ(well.output.find("FAILED"), std::string::npos) << well.output;
}

INSTANTIATE_TEST_SUITE_P(Wires, DriveStageScenario, testing::Values("tcp", "rtu"),
                         [](const auto& wire) { return std::string(wire.param); });

}  // namespace
}  // namespace gonio::test
