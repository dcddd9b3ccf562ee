// Every fault that the simulator knows by name, in the middle of a scan: what becomes of it stands in fault_outcomes.h,
// and whatever it is, no accepted point is wrong, and none is lost or doubled.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <sstream>

#include "sim/faults/fault_table.h"
#include "tests/scenario/bench.h"
#include "tests/scenario/fault_outcomes.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

using nlohmann::json;

// A surface whose BRDF changes by 3 % a degree at theta_i = 60 deg, so that an arm in a wrong place shows; and no drawn
// errors, so that a reading is off by its noise alone.
const SceneOptions kScene{
    .time_scale = 25.0, .draw_errors = false, .sample = "model = \"minnaert\"\nrho = 0.9\nk = 1.0\n"};
const PlanOptions kPlan{.theta_i_deg = "[60]",
                        .theta_r_deg = "[10, 40]",
                        .phi_r_deg = "[90, 180]",
                        .strategy = "as-written",
                        .target_snr = 500.0,
                        .on_item_error = "retry 2, then skip"};
constexpr long kItems = 2 * 4;

// f = rho / pi (cos theta_i cos theta_r)^k: Mobley 2005, after Minnaert 1941.
double truth_per_sr(const json& value) {
  const auto cosine = [&](const char* key) { return std::cos(value.at(key).get<double>() * std::numbers::pi / 180.0); };
  return 0.9 / std::numbers::pi * cosine("theta_i_deg") * cosine("theta_r_deg");
}

// Beside the stage on TCP, in the places of the camera and of the lamp's monitor.
constexpr const char* kMeters =
    "[[radiometers]]\nrole = \"detector\"\nserial = \"SIM-PM-01\"\nranges_w = [1e-4, 1e-3, 1e-2]\naverage_s = 0.02\n"
    "zero_s = 1.0\nnoise = 1e-4\nsamples = 4\n"
    "[[radiometers]]\nrole = \"monitor\"\nserial = \"SIM-PM-02\"\nranges_w = [1e-3, 1e-2]\naverage_s = 0.02\n"
    "noise = 2e-5\n";

SceneOptions scene_of(const std::string& instrument) {
  SceneOptions scene = kScene;
  if (instrument == "usb") {
    scene.more = kMeters;
  } else if (instrument == "drives") {
    scene.stage = instrument;
  } else {
    scene.stage_wire = instrument;
  }
  return scene;
}

/// One instrument and one daemon for many faults, one scan a fault; new ones after a fault that went wrong.
class Faults : public testing::TestWithParam<FaultRow> {
 protected:
  static Bench& bench(const std::string& instrument) {
    std::unique_ptr<Bench>& bench = benches_[instrument];
    if (bench) return *bench;
    bench = std::make_unique<Bench>(scene_of(instrument));
    bench->bring_up_daemon();
    return *bench;
  }
  static void TearDownTestSuite() { benches_.clear(); }
  void TearDown() override {
    if (HasFailure()) benches_.erase(std::string(GetParam().instrument));
  }

  void arm_in_mid_scan() {
    first_event_ = bench_.get("status").at("last_event").get<long>();
    fired_before_ = fired();
    scan_ = bench_.submit(plan_text(kPlan));
    EventReader events(bench_.daemon().port(), first_event_);
    ASSERT_TRUE(events.wait_for([](const auto& seen) { return count_of(seen, "item-accepted") >= 1; }, kStepDeadline))
        << bench_.log();
    (void)bench_.simulator().fault(std::string(GetParam().name), std::string(GetParam().keys));
  }

  [[nodiscard]] long fired() const {
    const json faults = json::parse(bench_.simulator().ask(R"({"query":"faults"})")).at("faults");
    const std::string name(GetParam().name);
    return faults.contains(name) ? faults.at(name).at("fired").get<long>() : 0;
  }

  // As an operator does: also when the device is still coming back.
  void go_on_once_the_cause_is_gone() {
    bench_.simulator().end_fault(std::string(GetParam().name));
    std::string state = "holding";
    for (int again = 0; again < 20 && state == "holding"; ++again) {
      bench_.reset_and_resume(scan_);
      state = bench_.wait_for_state(scan_, {"done", "failed", "aborted", "holding"});
    }
    EXPECT_EQ(state, "done") << bench_.log();
  }

  // Everything that was told from before the scan to its BRDF.
  void hear() {
    EventReader reader(bench_.daemon().port(), first_event_);
    EXPECT_TRUE(reader.wait_for([](const auto& seen) { return count_of(seen, "brdf-computed") >= 1; }, kStepDeadline))
        << bench_.log();
    events_ = reader.events();
  }
  [[nodiscard]] std::vector<json> told(const std::string& kind) const {
    std::vector<json> data;
    for (const ServerEvent& event : events_) {
      if (event.kind == kind) data.push_back(json::parse(event.data).at("data"));
    }
    return data;
  }

  void expect_outcome(const std::string& state, const std::string& holds) {
    const FaultRow& row = GetParam();
    const std::vector<json> failed = told("item-failed");
    const std::vector<json> skipped = told("item-skipped");
    const bool is_held = row.outcome == FaultOutcome::Held;
    EXPECT_GT(fired(), fired_before_) << "the fault has not come";
    EXPECT_EQ(state, is_held ? "holding" : "done") << holds << bench_.log();
    if (is_held) {
      EXPECT_TRUE(holds.starts_with(std::string(row.hold) + ": ")) << holds;
      const bool is_other_word = !row.or_says.empty() && holds.find(row.or_says) != std::string::npos;
      EXPECT_TRUE(is_other_word || holds.find(row.says) != std::string::npos) << holds;
    }
    if (row.outcome == FaultOutcome::Unnoticed) {
      EXPECT_TRUE(failed.empty()) << json(failed).dump();
    }
    if (row.outcome == FaultOutcome::Retried) {
      ASSERT_EQ(failed.size(), 1U) << json(failed).dump();
      EXPECT_NE(failed.front().at("error").dump().find(row.says), std::string::npos) << failed.front().dump();
    }
    const bool is_refused = row.outcome == FaultOutcome::Skipped;
    EXPECT_EQ(skipped.empty(), !is_refused) << json(skipped).dump();
    for (const json& item : skipped) EXPECT_NE(item.dump().find(row.says), std::string::npos) << item.dump();
  }

  void expect_nothing_lost_nothing_doubled() {
    const json report = bench_.scan(scan_);
    const std::vector<std::string> items = accepted_items(events_);
    EXPECT_EQ(items.size() + told("item-skipped").size(), static_cast<std::size_t>(kItems));
    EXPECT_EQ(report.at("accepted"), items.size());
    EXPECT_EQ(std::set<std::string>(items.begin(), items.end()).size(), items.size());
    EXPECT_TRUE(is_gapless_from(first_event_ + 1, events_));
  }

  // 5 standard uncertainties: chance gets there once in a million points, an arm that is off by a degree does.
  void expect_no_point_wrong() {
    long values = 0;
    const json report = bench_.get("scans/" + std::to_string(scan_) + "/brdf");
    for (const json& value : report.at("values")) {
      if (value.at("status") != "accepted") continue;
      ++values;
      EXPECT_NEAR(value.at("brdf_per_sr").get<double>(), truth_per_sr(value), 5.0 * value.at("u_per_sr").get<double>())
          << value.dump();
      EXPECT_LT(value.at("u_per_sr").get<double>(), 0.02 * truth_per_sr(value)) << "an uncertainty that hides nothing";
    }
    std::set<long> refused;
    for (const json& item : told("item-skipped")) refused.insert(item.at("point").get<long>());
    EXPECT_EQ(values, kItems / 2 - static_cast<long>(refused.size()));
  }

  inline static std::map<std::string, std::unique_ptr<Bench>> benches_;
  Bench& bench_ = bench(std::string(GetParam().instrument));
  long scan_ = 0;
  long first_event_ = 0;
  long fired_before_ = 0;
  std::vector<ServerEvent> events_;
};

TEST_P(Faults, HaveTheOutcomeOfTheTableInMidScan) {
  arm_in_mid_scan();

  const std::string state = bench_.wait_for_state(scan_, {"holding", "done", "failed", "aborted"});
  const std::string holds = bench_.holds_of(scan_);
  if (state == "holding") go_on_once_the_cause_is_gone();
  hear();

  SCOPED_TRACE(std::string(GetParam().name) + " " + std::string(GetParam().keys));
  expect_outcome(state, holds);
  expect_nothing_lost_nothing_doubled();
  expect_no_point_wrong();
}

INSTANTIATE_TEST_SUITE_P(ByName, Faults, testing::ValuesIn(kFaultRows),
                         [](const auto& row) { return std::string(row.param.test); });

TEST(FaultTable, HasARowForEveryFaultThatTheSimulatorKnows) {
  for (const sim::FaultTraits& fault : sim::kFaultTable) {
    EXPECT_TRUE(std::ranges::any_of(kFaultRows, [&](const FaultRow& row) { return row.name == fault.name; }))
        << fault.name;
  }
}

// A row of the operators' table begins with the fault's name and its outcome.
TEST(FaultTable, StandsInTheOperatorsDocumentWithTheSameOutcomes) {
  const std::string document = text_of(GONIO_FAULTS_DOCUMENT);
  for (const FaultRow& row : kFaultRows) {
    const std::string outcome = " | " + std::string(kFaultOutcomeNames[static_cast<std::size_t>(row.outcome)]) + " | ";
    std::istringstream lines(document);
    bool is_there = false;
    for (std::string line; std::getline(lines, line);) {
      is_there |= line.starts_with("| `" + std::string(row.name) + "`") && line.find(outcome) != std::string::npos;
    }
    EXPECT_TRUE(is_there) << row.name << outcome;
  }
}

}  // namespace
}  // namespace gonio::test
