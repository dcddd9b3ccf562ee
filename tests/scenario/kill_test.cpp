// Kill the daemon, the instrument or both at any instant: no accepted reading is lost or doubled, and the scan goes on
// with the next item. GONIO_KILLS, GONIO_KILL_SEED and GONIO_KILL_FIGURES (a file that takes one line) make a campaign
// of it: scripts/campaign.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

// The lives between two kills. One in three ends within the time that a start takes, while the daemon connects,
// verifies and prepares; the others end within a few items after their first one. A life so accepts few items, and the
// plan has more than all of them together.
constexpr Milliseconds kStartWindow{3000};
constexpr Milliseconds kMeasuringWindow{200};
// How long an instrument is without power before it is back.
constexpr Milliseconds kPowerlessWindow{300};
// An operator looks in so often, to resume a scan that holds because its instrument was gone.
constexpr Milliseconds kOperatorEvery{100};
const PlanOptions kPlan{.theta_i_deg = "[10, 25, 40, 55, 65]",
                        .theta_r_deg = "{from = 0, to = 70, step = 10}",
                        .phi_r_deg = "[60, 100, 140, 180]",
                        .target_snr = 4000.0};
constexpr long kPoints = 5 * (7 * 4 + 1);
constexpr double kTimeScale = 20.0;

// Chance alone goes beyond these in one of 5000 runs; uncertainties wrong by a third always do.
constexpr double kLeastP = 1e-4;
constexpr double kMostP = 1.0 - 1e-4;

enum class Victim : std::uint8_t { Daemon, Simulator, Both };
constexpr std::array kVictimNames{"goniod", "goniosim", "both"};

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
  long scan_ = 0;
  bool daemon_lives_ = false;
  long kills_since_inspection_ = 0;
  std::array<long, kVictimNames.size()> kills_of_{};

  Milliseconds within(Milliseconds window) {
    return Milliseconds(std::uniform_int_distribution<long>(0, window.count())(chance_));
  }
  bool one_in(int n) { return std::uniform_int_distribution<int>(0, n - 1)(chance_) == 0; }

  // Up to any instant of a start: of the daemon, or, where that has outlived the instrument, of its way back.
  void live_through_part_of_a_start(Ledger& ledger, Victim victim) {
    const auto end = Steady::now() + within(kStartWindow);
    if (!daemon_lives_) bench_.start_daemon();
    daemon_lives_ = true;
    if (!eventually([&] { return bench_.daemon().has_ready_file(); }, left_until(end))) return kill(victim);
    bench_.daemon().wait_until_ready();
    EventReader client(bench_.daemon().port(), ledger.last_number());
    do {
      bench_.help_if_on_hold(scan_);
    } while (!client.wait_for(kNever, std::min(kOperatorEvery, left_until(end))) && Steady::now() < end);
    kill(victim);
    ledger.hear(client.events());
  }

  // Up to soon after the first item.
  void live_through_a_few_items(Ledger& ledger, Victim victim) {
    bring_up_daemon();
    EventReader client(bench_.daemon().port(), ledger.last_number());
    wait_for_an_item(client);
    client.wait_for(kNever, within(kMeasuringWindow));
    kill(victim);
    ledger.hear(client.events());
  }

  void bring_up_daemon() {
    if (!daemon_lives_) bench_.bring_up_daemon();
    bench_.daemon().wait_until_ready();
    daemon_lives_ = true;
  }

  void wait_for_an_item(EventReader& client) {
    const auto end = Steady::now() + kStepDeadline;
    while (!client.wait_for(kFirstItem, kOperatorEvery) && Steady::now() < end) bench_.help_if_on_hold(scan_);
    EXPECT_TRUE(kFirstItem(client.events())) << "the scan does not go on. " << bench_.log();
  }

  void kill(Victim victim) {
    ++kills_since_inspection_;
    ++kills_of_[static_cast<std::size_t>(victim)];
    const bool instrument_first = victim == Victim::Simulator || (victim == Victim::Both && one_in(2));
    if (instrument_first) bench_.simulator().kill();
    if (victim != Victim::Simulator) bench_.daemon().kill();
    if (victim == Victim::Both && !instrument_first) bench_.simulator().kill();
    if (victim != Victim::Simulator) daemon_lives_ = false;
  }

  // The power is back after a moment that the daemon, if it lives, may notice or not.
  void give_power_back() {
    const auto end = Steady::now() + within(kPowerlessWindow);
    (void)eventually([&] { return Steady::now() >= end; }, kPowerlessWindow);
    bench_.simulator().restart();
  }

  // The store's file says nothing of value while a daemon writes it.
  void inspect(Ledger& ledger) {
    if (daemon_lives_) return;
    ledger.inspect(StoreCopy(bench_.files().store, bench_.folder()), bench_.simulator().exposures(),
                   kills_since_inspection_);
    kills_since_inspection_ = 0;
  }

  void finish(Ledger& ledger) {
    bring_up_daemon();
    ASSERT_NE(bench_.state_of(scan_), "done") << "the scan must last longer than the kills: the plan is too small";
    EventReader client(bench_.daemon().port(), ledger.last_number());
    const auto is_over = [](const auto& events) { return count_of(events, "scan-done") > 0; };
    const auto end = Steady::now() + kScanDeadline;
    while (!client.wait_for(is_over, kOperatorEvery) && Steady::now() < end) bench_.help_if_on_hold(scan_);
    ASSERT_EQ(bench_.state_of(scan_), "done") << bench_.holds_of(scan_) << bench_.log();
    EXPECT_EQ(bench_.scan(scan_).at("accepted"), 2 * kPoints);
    ledger.expect_retold(all_events(bench_, bench_.daemon().port()));
    EXPECT_EQ(bench_.end_daemon(), 0);
    daemon_lives_ = false;
    inspect(ledger);
  }

  void report(const Ledger& ledger, const ChiSquare& chi, Steady::duration took) const {
    std::ostringstream line;
    line << seed_ << '\t' << kills_of_[0] << '\t' << kills_of_[1] << '\t' << kills_of_[2] << '\t' << 2 * kPoints << '\t'
         << ledger.items_exposed_again() << '\t' << ledger.exposures_in_vain() << '\t' << chi.value << '\t'
         << chi.degrees_of_freedom << '\t' << chi.p << '\t'
         << std::chrono::duration_cast<std::chrono::seconds>(took).count() << '\n';
    std::cout << "seed, kills of goniod, of goniosim, of both, items, items exposed again, exposures in vain, "
                 "chi-square, degrees of freedom, p, seconds:\n"
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
  bring_up_daemon();
  scan_ = bench_.submit(plan_text(kPlan));
  Ledger ledger(scan_);

  for (long k = 0; k < kills_ && !HasFailure(); ++k) {
    const auto victim = static_cast<Victim>(std::uniform_int_distribution<std::size_t>(0, 2)(chance_));
    SCOPED_TRACE("kill " + std::to_string(k + 1) + ", of " + kVictimNames[static_cast<std::size_t>(victim)]);
    one_in(3) ? live_through_part_of_a_start(ledger, victim) : live_through_a_few_items(ledger, victim);
    if (victim != Victim::Daemon) give_power_back();
    inspect(ledger);
  }
  ASSERT_FALSE(HasFailure()) << bench_.log();

  finish(ledger);
  ASSERT_EQ(unbroken.wait_for_state(unbroken_scan, {"done", "failed", "aborted", "holding"}), "done") << unbroken.log();
  EXPECT_EQ(unbroken.end_daemon(), 0);
  const auto killed_values = StoreCopy(bench_.files().store, bench_.folder()).brdf(scan_);
  const auto whole_values = StoreCopy(unbroken.files().store, unbroken.folder()).brdf(unbroken_scan);
  const ChiSquare chi = agreement(killed_values, whole_values, is_of_one_run);
  EXPECT_EQ(chi.degrees_of_freedom, kPoints);
  EXPECT_GT(chi.p, kLeastP) << "chi-square " << chi.value;
  EXPECT_LT(chi.p, kMostP) << "chi-square " << chi.value;
  report(ledger, chi, Steady::now() - begin);
}

}  // namespace
}  // namespace gonio::test
