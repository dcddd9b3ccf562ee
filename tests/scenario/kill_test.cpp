// Kill the daemon at any instant: no accepted reading is lost or doubled, and the scan goes on with the next item.
// GONIO_KILLS, GONIO_KILL_SEED and GONIO_KILL_FIGURES (a file that takes one line) make a campaign of it:
// scripts/campaign.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "tests/scenario/agreement.h"
#include "tests/scenario/bench.h"
#include "tests/scenario/ledger.h"
#include "tests/scenario/programs.h"

namespace gonio::test {
namespace {

using Steady = std::chrono::steady_clock;
using Milliseconds = std::chrono::milliseconds;

// The lives of the daemon. One in three ends within the time that a start takes, while it connects, verifies and
// prepares; the others end within a few items after their first one. A killed life so accepts few items, and the plan
// has more than all of them together.
constexpr Milliseconds kStartWindow{3000};
constexpr Milliseconds kMeasuringWindow{200};
const PlanOptions kPlan{.theta_i_deg = "[10, 25, 40, 55]",
                        .theta_r_deg = "{from = 0, to = 70, step = 10}",
                        .phi_r_deg = "[60, 100, 140, 180]",
                        .target_snr = 4000.0};
constexpr long kPoints = 4 * (7 * 4 + 1);
constexpr double kTimeScale = 20.0;

// Chance alone goes beyond these in one of 5000 runs; uncertainties wrong by a third always do.
constexpr double kLeastP = 1e-4;
constexpr double kMostP = 1.0 - 1e-4;

std::uint64_t number_from(const char* variable, std::uint64_t fallback) {
  const char* text = std::getenv(variable);
  return text == nullptr ? fallback : std::strtoull(text, nullptr, 10);
}

const auto kNever = [](const std::vector<ServerEvent>&) { return false; };
const auto kFirstItem = [](const std::vector<ServerEvent>& events) {
  return count_of(events, "item-accepted") > 0 || count_of(events, "scan-done") > 0;
};

Milliseconds left_until(Steady::time_point instant) {
  return std::max(Milliseconds{0}, std::chrono::duration_cast<Milliseconds>(instant - Steady::now()));
}

class Kill : public testing::Test {
 protected:
  const std::uint64_t seed_ = number_from("GONIO_KILL_SEED", 1);
  const long kills_ = static_cast<long>(number_from("GONIO_KILLS", 50));
  std::mt19937_64 chance_{seed_};
  Bench bench_{SceneOptions{.time_scale = kTimeScale, .draw_errors = false, .seed = 2 * seed_}};

  Milliseconds within(Milliseconds window) {
    return Milliseconds(std::uniform_int_distribution<long>(0, window.count())(chance_));
  }

  // A life that ends while the daemon starts, or soon after.
  void live_through_part_of_a_start(Ledger& ledger) {
    const auto end = Steady::now() + within(kStartWindow);
    bench_.start_daemon();
    if (!eventually([&] { return bench_.daemon().has_ready_file(); }, left_until(end))) return bench_.daemon().kill();
    bench_.daemon().wait_until_ready();
    EventReader client(bench_.daemon().port(), ledger.last_number());
    client.wait_for(kNever, left_until(end));
    bench_.daemon().kill();
    ledger.hear(client.events());
  }

  // A life that ends soon after its first item.
  void live_through_a_few_items(Ledger& ledger) {
    bench_.bring_up_daemon();
    EventReader client(bench_.daemon().port(), ledger.last_number());
    EXPECT_TRUE(client.wait_for(kFirstItem, kStepDeadline)) << "the scan does not go on. " << bench_.log();
    client.wait_for(kNever, within(kMeasuringWindow));
    bench_.daemon().kill();
    ledger.hear(client.events());
  }

  void inspect_after_the_end(Ledger& ledger) {
    ledger.inspect(StoreCopy(bench_.files().store, bench_.folder()), bench_.simulator().exposures());
  }

  void report(const Ledger& ledger, const ChiSquare& chi, Steady::duration took) const {
    std::ostringstream line;
    line << seed_ << '\t' << kills_ << '\t' << 2 * kPoints << '\t' << ledger.items_exposed_again() << '\t'
         << ledger.exposures_in_vain() << '\t' << chi.value << '\t' << chi.degrees_of_freedom << '\t' << chi.p << '\t'
         << std::chrono::duration_cast<std::chrono::seconds>(took).count() << '\n';
    std::cout
        << "seed, kills, items, items exposed again, exposures in vain, chi-square, degrees of freedom, p, seconds:\n"
        << line.str();
    const char* file = std::getenv("GONIO_KILL_FIGURES");
    if (file != nullptr && !HasFailure()) std::ofstream(file, std::ios::app) << line.str();
  }
};

// What a run differs in from another on the same instrument without drawn errors: its own noise and its own darks.
bool is_of_one_run(const std::string& component) {
  return component.rfind("dark", 0) == 0;
}

TEST_F(Kill, AtRandomInstantsLosesNothingAndDoublesNothing) {
  SCOPED_TRACE("GONIO_KILL_SEED=" + std::to_string(seed_) + " GONIO_KILLS=" + std::to_string(kills_));
  const auto begin = Steady::now();
  Bench unbroken(SceneOptions{.time_scale = kTimeScale, .draw_errors = false, .seed = 2 * seed_ + 1});
  unbroken.bring_up_daemon();
  const long unbroken_scan = unbroken.submit(plan_text(kPlan));
  bench_.bring_up_daemon();
  const long scan = bench_.submit(plan_text(kPlan));
  Ledger ledger(scan);
  bench_.daemon().kill();
  inspect_after_the_end(ledger);

  for (long kill = 1; kill < kills_ && !HasFailure(); ++kill) {
    SCOPED_TRACE("kill " + std::to_string(kill));
    const bool in_start = std::uniform_int_distribution<int>(0, 2)(chance_) == 0;
    in_start ? live_through_part_of_a_start(ledger) : live_through_a_few_items(ledger);
    inspect_after_the_end(ledger);
  }
  ASSERT_FALSE(HasFailure()) << bench_.log();

  bench_.bring_up_daemon();
  ASSERT_NE(bench_.state_of(scan), "done") << "the scan must last longer than the kills: the plan is too small";
  ASSERT_EQ(bench_.wait_for_state(scan, {"done", "failed", "aborted", "holding"}), "done")
      << bench_.holds_of(scan) << bench_.log();
  EXPECT_EQ(bench_.scan(scan).at("accepted"), 2 * kPoints);
  ledger.expect_retold(all_events(bench_, bench_.daemon().port()));
  EXPECT_EQ(bench_.end_daemon(), 0);
  inspect_after_the_end(ledger);
  ASSERT_EQ(unbroken.wait_for_state(unbroken_scan, {"done", "failed", "aborted", "holding"}), "done") << unbroken.log();
  EXPECT_EQ(unbroken.end_daemon(), 0);

  const auto killed_values = StoreCopy(bench_.files().store, bench_.folder()).brdf(scan);
  const auto whole_values = StoreCopy(unbroken.files().store, unbroken.folder()).brdf(unbroken_scan);
  const ChiSquare chi = agreement(killed_values, whole_values, is_of_one_run);
  EXPECT_EQ(chi.degrees_of_freedom, kPoints);
  EXPECT_GT(chi.p, kLeastP) << "chi-square " << chi.value;
  EXPECT_LT(chi.p, kMostP) << "chi-square " << chi.value;
  report(ledger, chi, Steady::now() - begin);
}

}  // namespace
}  // namespace gonio::test
