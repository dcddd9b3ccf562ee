// Visits of the standard and of the sample: when they are made, what they see, and what is measured again for it.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "daemon/sequencer/visit_level.h"
#include "tests/daemon/sequencer/scan_rig.h"

namespace gonio::daemon {
namespace {

using calibration::Target;
using std::chrono::seconds;
using test::bench_plan;
using test::ScanRig;

// Twenty points: those at the normal are merged.
api::Plan plan_with_visits() {
  api::Plan plan;
  plan = bench_plan({0, 30}, {10, 20, 30, 40, 50}, {90, 120, 150});
  plan.block = seconds(40);
  plan.reference_every = seconds(15);
  return plan;
}

class Visits : public testing::Test {
 protected:
  std::vector<std::int64_t> column(const std::string& query) {
    std::vector<std::int64_t> values;
    const std::int64_t n = rig.count("SELECT count(*) FROM (" + query + ")");
    for (std::int64_t k = 0; k < n; ++k) values.push_back(rig.count(query + " LIMIT 1 OFFSET " + std::to_string(k)));
    return values;
  }
  std::int64_t events(const std::string& kind) { return std::ranges::count(rig.events, kind, &EventRecord::kind); }
  // The scan's time from end to end, of a lamp that is steady.
  Instant middle_of_scan(const api::Plan& plan) {
    ScanRig steady;
    steady.submit(plan);
    EXPECT_TRUE(steady.run_until([&] { return steady.count("SELECT count(*) FROM item") >= 20; }));
    return steady.clock().now();
  }

  ScanRig rig;
};

TEST_F(Visits, AreMadeByTimeWithinTheirSlackAndOnBothSidesOfEachItem) {
  const ScanId id = rig.submit(plan_with_visits());

  rig.run_to_rest();

  ASSERT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(rig.info(id).counts.accepted, 40);
  const auto made = column("SELECT boottime_ns FROM visit WHERE kind = 'reference' ORDER BY visit_id");
  ASSERT_GE(made.size(), 3U);
  for (std::size_t k = 1; k < made.size(); ++k) {
    // A period and its slack, and the item that was in hand then; the last visit closes the scan.
    EXPECT_LE(Duration(made[k] - made[k - 1]), seconds(18) + seconds(3)) << k;
    const bool is_last = k + 1 == made.size();
    EXPECT_TRUE(is_last || Duration(made[k] - made[k - 1]) >= seconds(12)) << k;
  }
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE started_boottime_ns < (SELECT min(boottime_ns) FROM visit "
                      "WHERE kind = 'reference') OR boottime_ns > (SELECT max(boottime_ns) FROM visit WHERE kind = "
                      "'reference')"),
            0);
  EXPECT_EQ(events("reference-visit"), std::ssize(made));
  EXPECT_EQ(events("items-reopened"), 0);
}

TEST_F(Visits, AreMadeOnTheSideOfTheCarriageThatTheyNeedWhereTheirTimeAllows) {
  api::Plan plan = plan_with_visits();
  plan.reference_every = seconds(40);  // as long as a block: both sides of the carriage lie within the slack

  rig.submit(plan);
  rig.run_to_rest();

  // The carriage goes over for a visit of the standard only where it would have gone anyway.
  const std::int64_t visits = rig.count("SELECT count(*) FROM visit WHERE kind = 'reference'");
  ASSERT_GE(visits, 2);
  const std::int64_t on_the_way = rig.count(
      "SELECT count(*) FROM visit v WHERE kind = 'reference' AND visit_id > 2 AND ((SELECT target FROM attempt a WHERE "
      "a.attempt_id = v.after_attempt) = 'reference' OR coalesce((SELECT target FROM attempt a WHERE a.attempt_id = "
      "v.after_attempt + 1), 'reference') = 'reference')");
  EXPECT_EQ(on_the_way, visits - 1) << "all but the first, which begins the run";
}

TEST_F(Visits, ExposeAlikeAndHaveTheirDarkOnBothSides) {
  rig.world.rate_dn_per_s = [](double theta_r, bool is_reference) { return is_reference ? 4e5 : 3e4 + 2e3 * theta_r; };
  api::Plan plan = plan_with_visits();
  plan.check_every = seconds(30);
  rig.submit(plan);

  rig.run_to_rest();

  EXPECT_EQ(rig.count("SELECT max(n) FROM (SELECT count(DISTINCT exposure_ns) AS n FROM reading JOIN visit_level USING "
                      "(visit_id) WHERE used = 1 GROUP BY target)"),
            1);
  EXPECT_EQ(rig.count("SELECT count(*) FROM visit_level l JOIN visit v USING (visit_id) WHERE NOT EXISTS (SELECT 1 "
                      "FROM visit d WHERE d.kind = 'dark' AND d.visit_id > v.visit_id)"),
            0);
}

TEST_F(Visits, TheSampleIsVisitedBesideTheStandardOnly) {
  api::Plan plan = plan_with_visits();
  plan.check_every = seconds(30);
  rig.submit(plan);

  rig.run_to_rest();

  EXPECT_GE(rig.count("SELECT count(*) FROM visit WHERE kind = 'check'"), 2);
  EXPECT_EQ(rig.count("SELECT count(*) FROM visit c WHERE kind = 'check' AND NOT EXISTS (SELECT 1 FROM visit r WHERE "
                      "r.kind = 'reference' AND r.visit_id = c.visit_id - 1 AND r.after_attempt = c.after_attempt)"),
            0);
}

TEST_F(Visits, ADriftWithinTheLimitMeasuresNothingAgain) {
  const Instant start = rig.clock().now();
  rig.world.gain = [start](Instant now) { return 1.0 + 0.02 * in_seconds(now - start) / 3600.0; };

  const ScanId id = rig.submit(plan_with_visits());
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(rig.count("SELECT count(*) FROM reopening"), 0);
  // Between two visits at most 18 s and an item: 2 % an hour makes a ten-thousandth of it.
  EXPECT_NEAR(rig.info(id).largest_drift, 1e-4, 4e-5);
}

TEST_F(Visits, AfterAStepJustThePointsBetweenTheTwoVisitsAreMeasuredAgain) {
  const Instant step = middle_of_scan(plan_with_visits());
  rig.world.gain = [step](Instant now) { return now < step ? 1.0 : 0.97; };

  const ScanId id = rig.submit(plan_with_visits());
  rig.run_to_rest();

  ASSERT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(events("items-reopened"), 1);
  EXPECT_NEAR(rig.info(id).largest_drift, 0.03, 1e-3);
  const std::string before = "(SELECT max(visit_id) FROM visit WHERE kind = 'reference' AND boottime_ns < " +
                             std::to_string(step.time_since_epoch().count()) + ")";
  const std::string after = "(SELECT min(visit_id) FROM visit WHERE kind = 'reference' AND boottime_ns >= " +
                            std::to_string(step.time_since_epoch().count()) + ")";
  const std::string between =
      "SELECT DISTINCT point_index FROM attempt WHERE attempt_id > (SELECT after_attempt FROM "
      "visit WHERE visit_id = " +
      before + ") AND attempt_id <= (SELECT after_attempt FROM visit WHERE visit_id = " + after + ") ORDER BY 1";
  const auto expected = column(between);
  EXPECT_FALSE(expected.empty());
  EXPECT_LT(expected.size(), 20U);
  EXPECT_EQ(column("SELECT DISTINCT point_index FROM reopening ORDER BY 1"), expected);
  EXPECT_EQ(column("SELECT DISTINCT point_index FROM item WHERE round = 2 ORDER BY 1"), expected);
  EXPECT_EQ(rig.count("SELECT count(*) FROM decided_item WHERE outcome = 'accepted'"), 40);
  EXPECT_EQ(rig.count("SELECT max(round) FROM item"), 2);
  EXPECT_EQ(rig.info(id).counts.reopened, std::ssize(expected));
}

TEST_F(Visits, ARetakeKeepsItsPartnersWithinOneBlock) {
  const Instant step = middle_of_scan(plan_with_visits());
  rig.world.gain = [step](Instant now) { return now < step ? 1.0 : 0.97; };

  rig.submit(plan_with_visits());
  rig.run_to_rest();

  EXPECT_LE(
      rig.count("SELECT max(b.boottime_ns - a.boottime_ns) FROM decided_item s JOIN decided_item r USING (scan_id, "
                "point_index) JOIN attempt a ON a.attempt_id = s.attempt_id JOIN attempt b ON b.attempt_id = "
                "r.attempt_id WHERE s.target = 'sample' AND r.target = 'reference'"),
      Duration(seconds(45)).count())
      << "a block, and the visits in it";
}

TEST_F(Visits, AChangeOfTheSampleAloneIsSeenByItsCheck) {
  api::Plan plan = plan_with_visits();
  plan.check_every = seconds(15);
  const Instant step = middle_of_scan(plan);
  rig.world.rate_dn_per_s = [this, step](double, bool is_reference) {
    return is_reference || rig.clock().now() < step ? 300'000.0 : 290'000.0;
  };

  const ScanId id = rig.submit(plan);
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_GT(rig.count("SELECT count(*) FROM reopening"), 0);
  EXPECT_EQ(rig.count("SELECT count(*) FROM reopening JOIN visit USING (visit_id) WHERE kind = 'reference'"), 0);
}

class EndlessDrift : public Visits {
 protected:
  // Between any two visits a percent or more: a lamp that is failing.
  void SetUp() override {
    const Instant start = rig.clock().now();
    rig.world.gain = [start](Instant now) { return std::exp(-in_seconds(now - start) / 1000.0); };
    plan.drift_limit = 0.005;
  }
  api::Plan plan = plan_with_visits();
};

TEST_F(EndlessDrift, IsMeasuredAgainAsOftenAsThePlanAllowsThenKept) {
  plan.drift_rounds = 1;

  const ScanId id = rig.submit(plan);
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(rig.count("SELECT max(round) FROM item"), 2);
  EXPECT_EQ(rig.count("SELECT count(*) FROM decided_item WHERE outcome = 'accepted'"), 40);
  EXPECT_NE(rig.events.back().kind, "scan-failed");
}

TEST_F(EndlessDrift, HoldsWhereThePlanAsksToHoldOnAnError) {
  plan.drift_rounds = 0;
  plan.on_item_error = api::OnItemError::Hold;

  const ScanId id = rig.submit(plan);
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::Holding);
  ASSERT_EQ(rig.status().active->holds.size(), 1U);
  EXPECT_NE(rig.status().active->holds[0].reason.find("drift"), std::string::npos)
      << rig.status().active->holds[0].reason;
}

TEST_F(EndlessDrift, OfAScanThatFinishesEarlyMeasuresNothingAgain) {
  const ScanId id = rig.submit(plan);
  ASSERT_TRUE(rig.run_until([&] { return rig.count("SELECT count(*) FROM item") >= 3; }));
  rig.command(FinishScan{id});
  rig.run_to_rest();

  EXPECT_EQ(rig.state_of(id), ScanState::FinishedEarly);
  EXPECT_EQ(rig.count("SELECT count(*) FROM reopening"), 0);
  EXPECT_EQ(rig.count("SELECT count(*) FROM visit WHERE kind = 'reference'"), 2) << "one before and one after";
}

TEST_F(Visits, AVisitThatFailsIsTriedAgainAndThenHolds) {
  bool is_broken = true;
  rig.world.move_error = [&is_broken](const MoveTo& to) -> std::optional<Error> {
    const bool to_the_standard = to.target[stage::index_of(stage::Axis::Carriage)].value_or(0.0) > 60.0;
    if (!is_broken || !to_the_standard) return std::nullopt;
    return Error{.code = ErrorCode::IncompleteData, .device = "stage", .tried = "move", .seen = "nothing"};
  };
  const ScanId id = rig.submit(plan_with_visits());
  rig.run_to_rest();

  ASSERT_EQ(rig.state_of(id), ScanState::Holding);
  EXPECT_EQ(rig.status().active->holds[0].reason.substr(0, 15), "reference visit");
  is_broken = false;
  rig.command(ResumeScan{id});
  rig.run_to_rest();
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
}

TEST(VisitPlace, IsThePointNearestTo045ThatIsNotBlocked) {
  std::vector<ScanPoint> points;
  for (const auto& [theta_i, theta_r, blocked] :
       std::vector<std::tuple<double, double, bool>>{{0, 45, true}, {30, 50, false}, {0, 60, false}, {0, 30, false}}) {
    const auto index = static_cast<std::int32_t>(points.size());
    points.push_back({.index = index,
                      .rank = 10 - index,
                      .geometry = {.theta_i = degrees(theta_i), .theta_r = degrees(theta_r)},
                      .blocked = blocked});
  }

  EXPECT_EQ(visit_point(points), 3) << "as near as the one before it, and measured sooner";
}

TEST(VisitDrift, IsBeyondItsLimitOnlyWhereChanceDoesNotExplainIt) {
  const VisitLevel before{.level = 2.0, .u_relative = 1e-3};
  const VisitLevel steady{.level = 2.008, .u_relative = 1e-3};
  const VisitLevel changed{.level = 2.012, .u_relative = 1e-3};
  VisitLevel noisy = changed;
  noisy.u_relative = 3e-3;

  EXPECT_FALSE(is_beyond(0.005, before, steady));
  EXPECT_TRUE(is_beyond(0.005, before, changed));
  EXPECT_FALSE(is_beyond(0.005, before, noisy)) << "6e-3 of 3 * 3.2e-3";
  EXPECT_NEAR(drift_between(before, changed), 0.006, 1e-12);
}

}  // namespace
}  // namespace gonio::daemon
