// A stage of ready-made drives and a coupler, each with its own unit id: no token, no gate, no epoch on the wire.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/scenario/bench.h"
#include "tests/scenario/csv_table.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

constexpr std::uint64_t kSeed = 7;

class DriveStageScenario : public testing::TestWithParam<const char*> {
 protected:
  DriveStageScenario() : bench_(SceneOptions{.seed = kSeed, .stage_wire = GetParam(), .stage = "drives"}) {
    bench_.bring_up_daemon();
  }
  CsvTable exported(long scan) {
    const std::string file = bench_.folder() + "/scan.csv";
    const Finished run = bench_.gonioctl({"data", "export", std::to_string(scan), "--format", "csv", "-o", file});
    EXPECT_EQ(run.exit_code, 0) << run.output << run.errors;
    return parse_csv(text_of(file));
  }
  CsvTable truth() {
    const Finished run = run_program({kGoniosim, "truth", bench_.scene_file(), "--seed", std::to_string(kSeed),
                                      "--points", bench_.folder() + "/scan.csv"},
                                     bench_.folder(), kStepDeadline);
    EXPECT_EQ(run.exit_code, 0) << run.errors;
    return parse_csv(run.output);
  }

  Bench bench_;
};

// 5 U is 10 standard uncertainties: chance never gets there, a wrong position, sign or shutter does.
TEST_P(DriveStageScenario, MeasuresWhatOnlyTheSimulatorKnows) {
  const long scan = bench_.submit(plan_text({}));
  ASSERT_EQ(bench_.wait_for_state(scan, {"done", "failed", "aborted", "holding"}), "done")
      << bench_.holds_of(scan) << bench_.log();

  const CsvTable measured = exported(scan);
  const CsvTable true_values = truth();

  ASSERT_EQ(true_values.rows.size(), measured.rows.size());
  int compared = 0;
  for (std::size_t i = 0; i < measured.rows.size(); ++i) {
    const auto& row = measured.rows[i];
    if (row.at("brdf_per_sr").empty()) continue;
    ++compared;
    EXPECT_NEAR(std::stod(row.at("brdf_per_sr")), std::stod(true_values.rows[i].at("brdf_per_sr")),
                5.0 * std::stod(row.at("expanded_u_per_sr")))
        << "point " << row.at("point");
  }
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
