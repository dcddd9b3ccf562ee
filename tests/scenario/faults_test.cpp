// Every fault that the simulator knows by name, in the middle of a scan: what becomes of it stands in fault_outcomes.h,
// and whatever it is, no accepted point is wrong and none is lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>

#include "sim/faults/fault_table.h"
#include "tests/scenario/bench.h"
#include "tests/scenario/fault_outcomes.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

using nlohmann::json;

// Without drawn errors a reading is off by its noise alone, so that a wrong one shows.
const SceneOptions kScene{.time_scale = 25.0, .draw_errors = false};
const PlanOptions kPlan{.theta_i_deg = "[20]",
                        .theta_r_deg = "[10, 40]",
                        .phi_r_deg = "[90, 180]",
                        .strategy = "as-written",
                        .on_item_error = "retry 2, then skip"};
constexpr long kItems = 2 * 4;
constexpr double kTruth_per_sr = 0.5 / std::numbers::pi;  // a Lambertian card of reflectance 0.5

std::string name_of(const FaultRow& row) {
  std::string name = std::string(row.name) + "_" + std::string(row.keys) + "_" + std::string(row.wire);
  std::ranges::replace_if(
      name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
}

/// One instrument and one daemon for many faults, one scan a fault; a new one after a fault that went wrong.
class Faults : public testing::TestWithParam<FaultRow> {
 protected:
  static Bench& bench(const std::string& wire) {
    std::unique_ptr<Bench>& bench = benches_[wire];
    if (!bench) {
      SceneOptions scene = kScene;
      scene.stage_wire = wire;
      bench = std::make_unique<Bench>(scene);
      bench->bring_up_daemon();
    }
    return *bench;
  }
  static void TearDownTestSuite() { benches_.clear(); }
  void TearDown() override {
    if (HasFailure()) benches_.erase(std::string(GetParam().wire));
  }

  void arm_in_mid_scan() {
    first_event_ = bench_.get("status").at("last_event").get<long>();
    scan_ = bench_.submit(plan_text(kPlan));
    EventReader events(bench_.daemon().port(), first_event_);
    ASSERT_TRUE(events.wait_for([](const auto& seen) { return count_of(seen, "item-accepted") >= 1; }, kStepDeadline))
        << bench_.log();
    fired_before_ = fired();
    (void)bench_.simulator().fault(std::string(GetParam().name), std::string(GetParam().keys));
  }

  [[nodiscard]] long fired() const {
    const json faults = json::parse(bench_.simulator().ask(R"({"query":"faults"})")).at("faults");
    const std::string name(GetParam().name);
    return faults.contains(name) ? faults.at(name).at("fired").get<long>() : 0;
  }

  void go_on_once_the_cause_is_gone() {
    bench_.simulator().end_fault(std::string(GetParam().name));
    std::string state = "holding";
    for (int again = 0; again < 20 && state == "holding"; ++again) {
      bench_.reset_and_resume(scan_);
      state = bench_.wait_for_state(scan_, {"done", "failed", "aborted", "holding"});
    }
    EXPECT_EQ(state, "done") << bench_.log();
  }

  [[nodiscard]] std::vector<json> errors_of_attempts() const {
    std::vector<json> errors;
    for (const ServerEvent& event : events_) {
      if (event.kind == "item-failed") errors.push_back(json::parse(event.data).at("data").at("error"));
    }
    return errors;
  }

  // Everything that was told since the scan began.
  void hear() {
    EventReader reader(bench_.daemon().port(), first_event_);
    reader.wait_for([](const auto& seen) { return count_of(seen, "brdf-computed") >= 1; }, kStepDeadline);
    events_ = reader.events();
  }

  void expect_nothing_lost_nothing_doubled() {
    const json report = bench_.scan(scan_);
    EXPECT_EQ(report.at("accepted"), kItems);
    EXPECT_EQ(report.at("skipped"), 0);
    EXPECT_TRUE(is_gapless_from(first_event_ + 1, events_));
    const std::vector<std::string> items = accepted_items(events_);
    EXPECT_EQ(items.size(), static_cast<std::size_t>(kItems));
    EXPECT_EQ(std::set<std::string>(items.begin(), items.end()).size(), items.size());
  }

  // 5 sigma of what is random, and the certificate's part is not drawn: chance gets there once in a million points.
  void expect_no_point_wrong() {
    const json values = bench_.get("scans/" + std::to_string(scan_) + "/brdf").at("values");
    EXPECT_EQ(values.size(), static_cast<std::size_t>(kItems / 2));
    for (const json& value : values) {
      EXPECT_NEAR(value.at("brdf_per_sr").get<double>(), kTruth_per_sr, 5.0 * value.at("u_per_sr").get<double>())
          << value.dump();
    }
  }

  inline static std::map<std::string, std::unique_ptr<Bench>> benches_;
  Bench& bench_ = bench(std::string(GetParam().wire));
  long scan_ = 0;
  long first_event_ = 0;
  long fired_before_ = 0;
  std::vector<ServerEvent> events_;
};

TEST_P(Faults, InMidScanHaveTheOutcomeOfTheTable) {
  const FaultRow& row = GetParam();
  arm_in_mid_scan();

  const std::string state = bench_.wait_for_state(scan_, {"holding", "done", "failed", "aborted"});
  const std::string holds = bench_.holds_of(scan_);
  if (state == "holding") {
    std::cerr << row.name << " HOLD " << holds;
    go_on_once_the_cause_is_gone();
  }
  hear();

  for (const json& error : errors_of_attempts()) std::cerr << row.name << " FAILED " << error.dump() << "\n";
  EXPECT_EQ(fired(), fired_before_ + 1) << "the fault has not come";
  EXPECT_EQ(state, row.outcome == FaultOutcome::Held ? "holding" : "done") << holds << bench_.log();
  if (row.outcome == FaultOutcome::Held) {
    EXPECT_TRUE(holds.starts_with(std::string(row.hold) + ": ")) << holds;
    EXPECT_NE(holds.find(row.says), std::string::npos) << holds;
  }
  const std::vector<json> errors = errors_of_attempts();
  if (row.outcome == FaultOutcome::Unnoticed) {
    EXPECT_TRUE(errors.empty()) << json(errors).dump();
  }
  if (row.outcome == FaultOutcome::Retried) {
    EXPECT_EQ(errors.size(), 1U) << json(errors).dump();
    EXPECT_TRUE(std::ranges::any_of(errors, [&](const json& error) {
      return error.at("detail").get<std::string>().find(row.says) != std::string::npos;
    })) << json(errors).dump();
  }
  expect_nothing_lost_nothing_doubled();
  expect_no_point_wrong();
}

INSTANTIATE_TEST_SUITE_P(ByName, Faults, testing::ValuesIn(kFaultRows),
                         [](const auto& row) { return name_of(row.param); });

TEST(FaultTable, HasARowForEveryFaultThatTheSimulatorKnows) {
  for (const sim::FaultTraits& fault : sim::kFaultTable) {
    EXPECT_TRUE(std::ranges::any_of(kFaultRows, [&](const FaultRow& row) { return row.name == fault.name; }))
        << fault.name;
  }
}

}  // namespace
}  // namespace gonio::test
