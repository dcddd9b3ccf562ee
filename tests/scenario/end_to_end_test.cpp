// A plan becomes BRDF values with uncertainties that a file carries away, all through the programs a user has.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/scenario/bench.h"
#include "tests/scenario/csv_table.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

constexpr std::uint64_t kSeed = 20260101;

// Of the 18 combinations of this plan 8 are merged: at theta_i = 0 two of three azimuths for each of three theta_r, at
// theta_i = 30, theta_r = 0 two of three. Of the 10 points 2 are in the detector's shadow: (0, 0) and (30, 30, 0).
const PlanOptions kPlan{};
constexpr long kPoints = 10;
constexpr long kMerged = 8;
constexpr long kBlocked = 2;

class EndToEnd : public testing::TestWithParam<const char*> {
 protected:
  EndToEnd() : bench_(std::string(kScenes) + "/" + GetParam() + ".toml", kSeed) { bench_.bring_up_daemon(); }

  // The scan's number.
  long measure(const PlanOptions& options = kPlan) {
    const std::string plan = bench_.file("plan.toml", plan_text(options));
    const Finished run = bench_.gonioctl({"scan", "run", plan, "--watch"});
    EXPECT_EQ(run.exit_code, 0) << run.output << run.errors << bench_.log();
    return bench_.get("scans").at("scans").at(0).at("id").get<long>();
  }

  CsvTable export_of(long scan) {
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

TEST_P(EndToEnd, CountsMeasuredBlockedAndMergedPoints) {
  const std::string plan = bench_.file("plan.toml", plan_text(kPlan));
  const Finished check = bench_.gonioctl({"plan", "check", plan, "-o", "json"});
  ASSERT_EQ(check.exit_code, 0) << check.output << check.errors;
  const auto dry_run = nlohmann::json::parse(check.output);

  const auto scan = bench_.scan(measure());

  for (const auto& report : {dry_run, scan}) {
    EXPECT_EQ(report.at("points"), kPoints);
    EXPECT_EQ(report.at("merged"), kMerged);
    EXPECT_EQ(report.at("blocked"), kBlocked);
    EXPECT_EQ(report.at("items"), 2 * (kPoints - kBlocked));
  }
  EXPECT_EQ(scan.at("state"), "done");
  EXPECT_EQ(scan.at("accepted"), 2 * (kPoints - kBlocked));
  EXPECT_EQ(scan.at("skipped"), 0);
  EXPECT_EQ(scan.at("brdf_values"), kPoints - kBlocked);
}

TEST_P(EndToEnd, ExportsEveryPointWithUnitsAndWhereItCameFrom) {
  const CsvTable table = export_of(measure());

  const std::vector<std::string> names{"point",           "theta_i_deg",   "phi_i_deg",   "theta_r_deg",
                                       "phi_r_deg",       "wavelength_nm", "brdf_per_sr", "u_random_per_sr",
                                       "u_shared_per_sr", "u_per_sr",      "k",           "expanded_u_per_sr",
                                       "status",          "flags"};
  EXPECT_EQ(table.names, names);
  EXPECT_GE(table.metadata.size(), 8U) << "scan, sample, hashes, reference, versions, times, k";
  ASSERT_EQ(table.rows.size(), static_cast<std::size_t>(kPoints));
  long blocked = 0;
  for (const auto& row : table.rows) {
    SCOPED_TRACE("point " + row.at("point"));
    const bool is_blocked = row.at("status") == "blocked";
    blocked += is_blocked ? 1 : 0;
    EXPECT_EQ(row.at("brdf_per_sr").empty(), is_blocked) << "blocked points are never filled in";
    if (is_blocked) continue;
    EXPECT_EQ(row.at("status"), "accepted");
    const double u = std::stod(row.at("u_per_sr"));
    const double random = std::stod(row.at("u_random_per_sr"));
    const double shared = std::stod(row.at("u_shared_per_sr"));
    EXPECT_GT(random, 0.0);
    EXPECT_GT(shared, 0.0);
    EXPECT_NEAR(u, std::hypot(random, shared), 1e-4 * u);
    EXPECT_GE(std::stod(row.at("k")), 1.99);
    EXPECT_NEAR(std::stod(row.at("expanded_u_per_sr")), u * std::stod(row.at("k")), 1e-3 * u);
  }
  EXPECT_EQ(blocked, kBlocked);
}

// 5 U is 10 standard uncertainties: chance never gets there, a wrong factor, dark or angle does.
void expect_agreement(const CsvTable& measured, const CsvTable& true_values) {
  ASSERT_EQ(true_values.rows.size(), measured.rows.size());
  for (std::size_t i = 0; i < measured.rows.size(); ++i) {
    const auto& row = measured.rows[i];
    ASSERT_EQ(true_values.rows[i].at("point"), row.at("point"));
    if (row.at("brdf_per_sr").empty()) continue;
    const double truth_per_sr = std::stod(true_values.rows[i].at("brdf_per_sr"));
    EXPECT_GT(truth_per_sr, 0.0);
    EXPECT_NEAR(std::stod(row.at("brdf_per_sr")), truth_per_sr, 5.0 * std::stod(row.at("expanded_u_per_sr")))
        << "point " << row.at("point");
  }
}

TEST_P(EndToEnd, AgreesWithTheTruthThatOnlyTheSimulatorKnows) {
  const CsvTable measured = export_of(measure());

  expect_agreement(measured, truth());
}

// Across the lobe, the plan states three exposures, 1 to 128: the peak and the flank cannot use the same ones.
TEST_P(EndToEnd, AgreesWithTheTruthWhenThePlanBracketsItsExposures) {
  const CsvTable measured = export_of(measure({.theta_i_deg = "[30]",
                                               .theta_r_deg = "[10, 30, 50, 70]",
                                               .phi_r_deg = "[90, 180]",
                                               .exposure_s = "[0.0001, 0.0016, 0.0128]"}));

  expect_agreement(measured, truth());
}

TEST_P(EndToEnd, TellsEveryChangeOnceInOrder) {
  const long scan = measure();

  // The BRDF is computed aside, after the scan is done; its event is the last.
  std::vector<ServerEvent> events;
  const auto has_brdf = [&] {
    events = all_events(bench_, bench_.daemon().port());
    return count_of(events, "brdf-computed") > 0;
  };
  EXPECT_TRUE(eventually(has_brdf, kStepDeadline)) << bench_.log();

  EXPECT_TRUE(is_gapless_from(1, events));
  EXPECT_EQ(count_of(events, "scan-submitted"), 1);
  EXPECT_EQ(count_of(events, "scan-done"), 1);
  EXPECT_EQ(count_of(events, "brdf-computed"), 1);
  EXPECT_GE(count_of(events, "dark-visit"), 2) << "one before and one after";
  const std::vector<std::string> items = accepted_items(events);
  EXPECT_EQ(items.size(), static_cast<std::size_t>(2 * (kPoints - kBlocked)));
  EXPECT_EQ(std::set<std::string>(items.begin(), items.end()).size(), items.size());
  EXPECT_EQ(bench_.get("status").at("last_event"), events.back().number);
  EXPECT_EQ(bench_.state_of(scan), "done");
}

INSTANTIATE_TEST_SUITE_P(Scenes, EndToEnd, testing::Values("wheat", "glint"),
                         [](const auto& scene) { return std::string(scene.param); });

}  // namespace
}  // namespace gonio::test
