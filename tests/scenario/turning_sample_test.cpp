// A scan on a stage whose source stands still: the sample turns, the detector is on an arm.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "tests/scenario/agreement.h"
#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"
#include "tests/scenario/store_copy.h"

namespace gonio::test {
namespace {

constexpr std::uint64_t kSeed = 5;

TEST(TurningSample, AScanAgreesWithTheTruthByChiSquare) {
  const std::string scene = kScenes + std::string("/turning.toml");
  Bench bench(scene, kSeed);
  bench.bring_up_daemon();
  // 27 combinations: at theta_i = 0 two of three azimuths are merged for each of three theta_r, at theta_r = 0 two of
  // three for each other theta_i; of the 17 points (0, 0) lies in the shadow.
  const std::string plan = bench.file(
      "plan.toml",
      plan_text({.theta_i_deg = "[0, 30, 55]", .theta_r_deg = "[0, 20, 65]", .phi_r_deg = "[45, 120, 180]"}));
  const Finished run = bench.gonioctl({"scan", "run", plan, "--watch"});
  ASSERT_EQ(run.exit_code, 0) << run.output << run.errors << bench.log();
  EXPECT_EQ(bench.state_of(1), "done");
  const auto has_brdf = [&] { return count_of(all_events(bench, bench.daemon().port()), "brdf-computed") > 0; };
  EXPECT_TRUE(eventually(has_brdf, kStepDeadline)) << bench.log();
  const CsvTable truth = bench.measured_and_true(1).truth;
  bench.end_daemon();

  const auto measured = StoreCopy(bench.files().store, bench.folder()).brdf(1);
  std::map<long, StoredValue> expected;
  for (const auto& row : truth.rows) {
    if (!row.at("brdf_per_sr").empty()) {
      expected[std::stol(row.at("point"))] = {.value = std::stod(row.at("brdf_per_sr"))};
    }
  }
  // Of the truth nothing is uncertain; of the measurement every component was drawn once.
  const ChiSquare chi = agreement(measured, expected, [](const std::string&) { return true; });

  EXPECT_EQ(chi.degrees_of_freedom, 16);
  EXPECT_GT(chi.p, 0.001) << "chi-square " << chi.value << " of " << chi.degrees_of_freedom;
  EXPECT_LT(chi.p, 0.999) << "chi-square " << chi.value << " of " << chi.degrees_of_freedom;
}

}  // namespace
}  // namespace gonio::test
