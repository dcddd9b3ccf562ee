// A plan becomes BRDF values with uncertainties that a file carries away, all through the programs a user has.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/scenario/bench.h"
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
  const CsvTable table = bench_.exported(measure());

  const std::vector<std::string> names{"point",           "theta_i_deg",   "phi_i_deg",   "theta_r_deg",
                                       "phi_r_deg",       "wavelength_nm", "brdf_per_sr", "u_random_per_sr",
                                       "u_shared_per_sr", "u_per_sr",      "k",           "expanded_u_per_sr",
                                       "below_per_sr",    "above_per_sr",  "status",      "flags"};
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

TEST_P(EndToEnd, AgreesWithTheTruthThatOnlyTheSimulatorKnows) {
  const long scan = measure();

  EXPECT_EQ(expect_agreement(bench_.measured_and_true(scan)), kPoints - kBlocked);
}

// A good scan says so of itself, and what its uncertainty is made of.
TEST_P(EndToEnd, PassesItsSelfChecksAndShowsABudget) {
  const std::string scan = std::to_string(measure());

  const Finished checks = bench_.gonioctl({"data", "check", scan});
  EXPECT_EQ(checks.exit_code, 0) << checks.output << checks.errors;
  EXPECT_NE(checks.output.find("passed: "), std::string::npos) << checks.output;
  const Finished budget = bench_.gonioctl({"data", "budget", scan});
  EXPECT_EQ(budget.exit_code, 0) << budget.errors;
  EXPECT_NE(budget.output.find("certificate"), std::string::npos) << budget.output;
  EXPECT_NE(bench_.gonioctl({"scan", "show", scan}).output.find("checks"), std::string::npos);
}

// Across the lobe, the plan states three exposures, 1 to 128: the peak and the flank cannot use the same ones.
TEST_P(EndToEnd, AgreesWithTheTruthWhenThePlanBracketsItsExposures) {
  const long scan = measure({.theta_i_deg = "[30]",
                             .theta_r_deg = "[10, 30, 50, 70]",
                             .phi_r_deg = "[90, 180]",
                             .exposure_s = "[0.0001, 0.0016, 0.0128]"});

  EXPECT_GT(expect_agreement(bench_.measured_and_true(scan)), 0);
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
