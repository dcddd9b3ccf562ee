// The power goes at any instant of a scan, in mid-commit and in mid-checkpoint: what was told is there afterwards, and
// the scan goes on with the next item. GONIO_CUTS, GONIO_CUT_SEED and GONIO_CUT_FIGURES (a file that takes one line)
// make a campaign of it: scripts/campaign.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>

#include "tests/daemon/sequencer/scan_rig.h"
#include "tests/support/power_cut_disk.h"

namespace gonio::daemon {
namespace {

using gonio::test::PowerCutDisk;
using test::bench_plan;
using test::ScanRig;
using test::ScratchFolder;

std::uint64_t number_from(const char* variable, std::uint64_t fallback) {
  const char* text = std::getenv(variable);
  return text == nullptr ? fallback : std::strtoull(text, nullptr, 10);
}

api::Plan small_plan() {
  api::Plan plan = bench_plan({30}, {10, 20}, {90});
  plan.target_snr = 200;
  plan.max_time = std::chrono::milliseconds(2);
  return plan;
}
constexpr std::int64_t kItems = 4;

/// What is wrong with a store after a cut, as a plain reader of the file finds it.
struct Damage {
  std::string integrity = "ok";
  long told_events_lost = 0;  ///< or changed
  bool has_gap = false;
  [[nodiscard]] bool any() const { return integrity != "ok" || told_events_lost > 0 || has_gap; }
};

Damage damage_of(const std::string& path, const std::vector<EventRecord>& told) {
  Damage damage;
  try {
    const SQLite::Database database(path, SQLite::OPEN_READONLY);
    SQLite::Statement check(database, "PRAGMA integrity_check");
    damage.integrity = check.executeStep() ? check.getColumn(0).getString() : "no answer";
    SQLite::Statement event(database, "SELECT json FROM event WHERE number = ?");
    for (const EventRecord& heard : told) {
      event.reset();
      event.bind(1, heard.number);
      if (!event.executeStep() || event.getColumn(0).getString() != heard.json) ++damage.told_events_lost;
    }
    SQLite::Statement gap(database, "SELECT count(*) <> coalesce(max(number), 0) FROM event");
    damage.has_gap = gap.executeStep() && gap.getColumn(0).getInt() != 0;
  } catch (const SQLite::Exception& exception) {
    damage.integrity = exception.what();
  }
  return damage;
}

std::int64_t items_exposed_in_vain(ScanRig& rig) {
  return std::ranges::count_if(rig.world.exposed_at, [&rig](const auto& exposed) {
    const auto& [item, exposures] = exposed;
    return exposures >
           rig.count(
               "SELECT count(*) FROM reading JOIN attempt USING (attempt_id) JOIN point USING (scan_id, "
               "point_index) WHERE target = '" +
               std::string(target_name(item.target)) + "' AND round(theta_r_deg) = " + std::to_string(item.point));
  });
}

void expect_each_item_once(ScanRig& rig, ScanId id) {
  EXPECT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(rig.count("SELECT count(*) FROM item WHERE outcome = 'accepted'"), kItems);
  EXPECT_EQ(rig.count("SELECT count(*) FROM attempt WHERE outcome = 'accepted'"), kItems);
  EXPECT_EQ(rig.count("SELECT count(*) FROM event WHERE kind = 'item-accepted'"), kItems);
  EXPECT_EQ(rig.count("SELECT count(*) FROM event"), rig.count("SELECT max(number) FROM event"));
  EXPECT_EQ(damage_of(rig.store_path(), rig.events).integrity, "ok");
}

class PowerCut : public testing::Test {
 protected:
  /// Operations of the disk from the scan's acceptance to the end of a daemon that closes its store.
  static std::uint64_t operations_of_unbroken_scan() {
    const ScratchFolder folder;
    PowerCutDisk disk;
    ScanRig rig(test::bench_instrument(), folder.file("store.sqlite"));
    rig.submit(small_plan());
    const std::uint64_t first = disk.operations();
    rig.run_to_rest();
    rig.kill();
    return disk.operations() - first;
  }

  /// A scan up to a cut, which comes at its end at the latest.
  static void run_until_cut(ScanRig& rig, const PowerCutDisk& disk) {
    while (!disk.is_cut() && rig.step()) {
    }
    rig.kill();
  }
};

struct CutFigures {
  long cuts = 0;
  long items = 0;
  long items_exposed_again = 0;
  long told_before = 0;
};

void report(std::uint64_t seed, const CutFigures& figures, std::chrono::steady_clock::duration took) {
  std::ostringstream line;
  line << seed << '\t' << figures.cuts << '\t' << figures.items << '\t' << figures.items_exposed_again << '\t'
       << figures.told_before << '\t' << std::chrono::duration_cast<std::chrono::seconds>(took).count() << '\n';
  std::cout << "seed, cuts, items, items exposed again, events told before the cuts, seconds:\n" << line.str();
  const char* file = std::getenv("GONIO_CUT_FIGURES");
  if (file != nullptr && !testing::Test::HasFailure()) std::ofstream(file, std::ios::app) << line.str();
}

TEST_F(PowerCut, AtARandomOperationOfTheDiskLosesNothingAndDoublesNothing) {
  const auto begin = std::chrono::steady_clock::now();
  const std::uint64_t first_seed = number_from("GONIO_CUT_SEED", 1);
  const std::uint64_t cuts = number_from("GONIO_CUTS", 20);
  const std::uint64_t operations = operations_of_unbroken_scan();
  ASSERT_GT(operations, 50U);

  CutFigures figures;
  for (std::uint64_t seed = first_seed; seed < first_seed + cuts && !HasFailure(); ++seed) {
    SCOPED_TRACE("cut of seed " + std::to_string(seed));
    std::mt19937_64 chance(seed);
    const ScratchFolder folder;
    PowerCutDisk disk;
    ScanRig rig(test::bench_instrument(), folder.file("store.sqlite"));
    const ScanId id = rig.submit(small_plan());
    disk.cut_at(disk.operations() + std::uniform_int_distribution<std::uint64_t>(1, operations)(chance));
    run_until_cut(rig, disk);
    ASSERT_TRUE(disk.is_cut());
    disk.restore(chance());
    const Damage damage = damage_of(rig.store_path(), rig.events);
    EXPECT_EQ(damage.integrity, "ok");
    EXPECT_EQ(damage.told_events_lost, 0);
    EXPECT_FALSE(damage.has_gap);

    figures.told_before += static_cast<long>(rig.events.size());
    rig.start();
    rig.run_to_rest();

    expect_each_item_once(rig, id);
    const std::int64_t again = items_exposed_in_vain(rig);
    EXPECT_LE(again, 1) << "at most one item is exposed again";
    ++figures.cuts;
    figures.items += kItems;
    figures.items_exposed_again += again;
    rig.kill();
  }
  report(first_seed, figures, std::chrono::steady_clock::now() - begin);
}

// Sums stand in the transaction of their reading: each is whole, or is not there and its frames are taken again.
TEST_F(PowerCut, LeavesAMapJobTheSumsOfWholeReadings) {
  for (std::uint64_t seed = 1; seed <= 10 && !HasFailure(); ++seed) {
    SCOPED_TRACE("cut of seed " + std::to_string(seed));
    std::mt19937_64 chance(seed);
    const ScratchFolder folder;
    PowerCutDisk disk;
    ScanRig rig(test::bench_instrument(), folder.file("store.sqlite"));
    const ScanId id = rig.submit(test::map_plan());
    constexpr std::uint64_t kLastOperation = 60;
    disk.cut_at(disk.operations() + std::uniform_int_distribution<std::uint64_t>(1, kLastOperation)(chance));
    run_until_cut(rig, disk);
    ASSERT_TRUE(disk.is_cut());
    disk.restore(chance());
    EXPECT_FALSE(damage_of(rig.store_path(), rig.events).any());
    rig.start();
    rig.run_to_rest();

    expect_each_item_once(rig, id);
    test::expect_sums_of_whole_readings(rig, id);
    rig.kill();
  }
}

TEST_F(PowerCut, AgainAndAgainWhileItRecoversStillArrives) {
  const std::uint64_t seed = number_from("GONIO_CUT_SEED", 1);
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 chance(seed);
  const ScratchFolder folder;
  PowerCutDisk disk;
  ScanRig rig(test::bench_instrument(), folder.file("store.sqlite"));
  const ScanId id = rig.submit(small_plan());

  // Progress is made only if the time between cuts allows an item: it grows, as an operator's patience would not.
  constexpr std::uint64_t kCuts = 25;
  for (std::uint64_t cut = 1; cut <= kCuts && !HasFailure(); ++cut) {
    disk.cut_at(disk.operations() + std::uniform_int_distribution<std::uint64_t>(1, 4 + 2 * cut)(chance));
    if (rig.is_started() || rig.try_start()) run_until_cut(rig, disk);
    disk.restore(chance());
    const Damage damage = damage_of(rig.store_path(), rig.events);
    EXPECT_FALSE(damage.any()) << "cut " << cut << ": " << damage.integrity << ", " << damage.told_events_lost
                               << " events lost";
  }
  rig.start();
  rig.run_to_rest();

  expect_each_item_once(rig, id);
  EXPECT_LE(items_exposed_in_vain(rig), static_cast<std::int64_t>(kCuts));
  rig.kill();
}

TEST_F(PowerCut, WhileTheStoreIsMadeLeavesOneThatCanBeMade) {
  for (std::uint64_t operation = 1;; ++operation) {
    SCOPED_TRACE("operation " + std::to_string(operation));
    const ScratchFolder folder;
    const std::string path = folder.file("store.sqlite");
    PowerCutDisk disk;
    disk.cut_at(operation);
    const ManualClock clock;
    const StoreOptions options{.path = path, .boot_id = "boot", .version = "test"};
    (void)StoreWriter::open(options, clock);
    if (!disk.is_cut()) break;
    disk.restore(operation);

    const auto again = StoreWriter::open(options, clock);

    ASSERT_TRUE(again) << describe(again.error());
    EXPECT_FALSE(damage_of(path, {}).any());
  }
}

// The tests above are worth what this one finds: a disk that only says that it has synced loses what was told.
TEST_F(PowerCut, OnADiskThatDoesNotKeepItsWordLosesWhatWasTold) {
  const std::uint64_t operations = operations_of_unbroken_scan();
  int damaged = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 chance(seed);
    const ScratchFolder folder;
    PowerCutDisk disk(false);
    ScanRig rig(test::bench_instrument(), folder.file("store.sqlite"));
    rig.submit(small_plan());
    disk.cut_at(disk.operations() + std::uniform_int_distribution<std::uint64_t>(1, operations)(chance));
    run_until_cut(rig, disk);
    disk.restore(chance());
    if (damage_of(rig.store_path(), rig.events).any()) ++damaged;
  }

  EXPECT_GT(damaged, 10) << "of 20 cuts";
}

}  // namespace
}  // namespace gonio::daemon
