// The same scan with the stage on a serial line, chosen by configuration alone; and STOP over it.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/scenario/bench.h"
#include "tests/scenario/csv_table.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

CsvTable measure(Bench& bench, const std::string& plan_text) {
  bench.bring_up_daemon();
  const std::string plan = bench.file("plan.toml", plan_text);
  const Finished run = bench.gonioctl({"scan", "run", plan, "--watch"});
  EXPECT_EQ(run.exit_code, 0) << run.output << run.errors << bench.log();
  const std::string file = bench.folder() + "/scan.csv";
  const Finished exported = bench.gonioctl({"data", "export", "1", "--format", "csv", "-o", file});
  EXPECT_EQ(exported.exit_code, 0) << exported.output << exported.errors;
  return parse_csv(text_of(file));
}

// 5 U is 10 standard uncertainties of either: chance never gets there, a wrong position or a stale value does.
TEST(SerialLine, GivesTheSamePointsAsTcp) {
  const std::string plan = plan_text({});
  Bench tcp{SceneOptions{}};
  Bench rtu{SceneOptions{.stage_wire = "rtu"}};

  const CsvTable over_tcp = measure(tcp, plan);
  const CsvTable over_rtu = measure(rtu, plan);

  ASSERT_EQ(over_rtu.rows.size(), over_tcp.rows.size());
  ASSERT_FALSE(over_rtu.rows.empty());
  for (std::size_t i = 0; i < over_rtu.rows.size(); ++i) {
    const auto& a = over_tcp.rows[i];
    const auto& b = over_rtu.rows[i];
    SCOPED_TRACE("point " + a.at("point"));
    for (const char* name : {"point", "wavelength_nm", "status"}) EXPECT_EQ(a.at(name), b.at(name)) << name;
    ASSERT_EQ(a.at("brdf_per_sr").empty(), b.at("brdf_per_sr").empty());
    if (a.at("brdf_per_sr").empty()) continue;
    EXPECT_NEAR(std::stod(a.at("brdf_per_sr")), std::stod(b.at("brdf_per_sr")),
                5.0 * std::stod(a.at("expanded_u_per_sr")));
  }
}

TEST(SerialLine, StopsAScanThatGoesOnAfterAReset) {
  Bench bench{SceneOptions{.time_scale = 4.0, .stage_wire = "rtu"}};
  bench.bring_up_daemon();
  bench.home();
  const long scan = bench.submit(
      plan_text({.theta_i_deg = "[10, 70]", .theta_r_deg = "[0, 50]", .phi_r_deg = "[180]", .strategy = "as-written"}));
  EXPECT_TRUE(eventually([&] { return bench.simulator().stage().axes.at("theta_i").moving; }, kStepDeadline))
      << bench.log();

  const HttpAnswer answer = bench.daemon().post("stop");

  EXPECT_EQ(answer.status, 200) << answer.body;
  EXPECT_TRUE(eventually([&] { return bench.simulator().stage().halted; }, kStepDeadline));
  EXPECT_TRUE(eventually([&] { return !bench.simulator().stage().moving; }, kStepDeadline));
  EXPECT_EQ(bench.wait_for_state(scan, {"holding", "done"}), "holding");
  bench.reset_and_resume(scan);
  EXPECT_EQ(bench.wait_for_state(scan, {"done", "failed", "aborted"}), "done") << bench.log();
  EXPECT_EQ(bench.scan(scan).at("accepted"), 8);
}

}  // namespace
}  // namespace gonio::test
