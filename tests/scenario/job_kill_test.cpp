// A calibration job is a scan like any other: killed again and again it goes on, no item is lost or doubled, and what
// it finds is found once, from all of its readings. Its points lie apart: the ledger tells items by their places.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/scenario/bench.h"
#include "tests/scenario/ledger.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

constexpr int kKills = 6;
constexpr long kPoints = 12;
constexpr double kOffset_s = 1e-4;  // scene time
constexpr double kTimeScale = 40.0;

constexpr const char* kKilledLadder = R"([scan]
name = "ladder"
sample = "card"
[calibration]
job = "linearity"
order = 1
[geometry]
theta_i_deg = [0]
theta_r_deg = [15, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70]
phi_r_deg = [90]
wavelength_nm = [568]
[reading]
max_time_s = 1
exposure_s = [2.5e-5, 5e-5, 1e-4, 2e-4, 4e-4]
[reference]
standard = "SRT-99-020"
block_s = 20
[visits]
dark_s = 10
)";

class JobKill : public testing::Test {
 protected:
  Bench bench_{SceneOptions{.time_scale = kTimeScale,
                            .draw_errors = false,
                            .seed = 20261123,
                            .more = "[effects]\nexposure_offset_s = 1e-4\n"}};

  // A daemon that is killed once this many items more were accepted, in its scan's midst.
  void live_through(Ledger& ledger, long scan, int items) {
    if (bench_.state_of(scan) == "done") return;
    EventReader client(bench_.daemon().port(), ledger.last_number());
    const auto has_them = [&](const auto& events) {
      return count_of(events, "item-accepted") >= items || count_of(events, "scan-done") > 0;
    };
    EXPECT_TRUE(client.wait_for(has_them, kStepDeadline)) << bench_.log();
    bench_.daemon().kill();
    ledger.hear(client.events());
    ledger.inspect(StoreCopy(bench_.files().store, bench_.folder()), bench_.simulator().exposures());
    bench_.bring_up_daemon();
  }

  nlohmann::json versions_of(long scan) {
    nlohmann::json found = nlohmann::json::array();
    const nlohmann::json list = bench_.get("calibrations");
    for (const auto& one : list.at("calibrations")) {
      if (one.at("scan") == scan) found.push_back(one);
    }
    return found;
  }
};

TEST_F(JobKill, LosesNothingDoublesNothingAndFindsItsValueOnce) {
  bench_.bring_up_daemon();
  const long scan = bench_.submit(kKilledLadder);
  Ledger ledger(scan);

  for (int kill = 0; kill < kKills; ++kill) live_through(ledger, scan, 1 + kill % 3);
  ASSERT_EQ(bench_.wait_for_state(scan, {"done", "failed", "aborted"}), "done") << bench_.log();
  ASSERT_TRUE(eventually([&] { return !versions_of(scan).empty(); }, kStepDeadline)) << bench_.log();
  bench_.daemon().kill();  // once more, after the finding
  bench_.bring_up_daemon();

  EXPECT_EQ(bench_.scan(scan).at("accepted"), 2 * kPoints);
  const nlohmann::json versions = versions_of(scan);
  ASSERT_EQ(versions.size(), 1U) << versions;
  const auto inputs = nlohmann::json::parse(versions.at(0).at("inputs").get<std::string>());
  EXPECT_GE(inputs.at("readings"), 2 * kPoints + 2) << "all items, and darks before and after";
  for (const auto& value : versions.at(0).at("values")) {
    if (value.at("name") != "exposure_offset_s") continue;
    EXPECT_NEAR(value.at("value").get<double>(), kOffset_s / kTimeScale, 5.0 * value.at("u").get<double>()) << versions;
  }
}

}  // namespace
}  // namespace gonio::test
