#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <limits>
#include <memory>

#include "daemon/config/configuration_hash.h"
#include "daemon/store/store_actor.h"
#include "daemon/store/store_reader.h"
#include "daemon/store/store_writer.h"
#include "tests/daemon/support/scan_records.h"

namespace gonio::daemon {
namespace {

using calibration::Target;
using test::bench_plan;
using test::new_scan;
using test::reading_of;

class Store : public testing::Test {
 protected:
  void SetUp() override { writer_ = open_writer(); }

  std::unique_ptr<StoreWriter> open_writer() {
    auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
    EXPECT_TRUE(writer) << describe(writer.error());
    return writer ? std::move(*writer) : nullptr;
  }

  std::unique_ptr<StoreReader> open_reader() {
    auto reader = StoreReader::open(path_);
    EXPECT_TRUE(reader) << describe(reader.error());
    return reader ? std::move(*reader) : nullptr;
  }

  Result<CommitReceipt> commit(std::vector<StoreWrite> writes, std::vector<NewEvent> events = {}) {
    clock_.advance(std::chrono::milliseconds(100));
    return writer_->commit({.at = clock_.now(), .writes = std::move(writes), .events = std::move(events)});
  }

  // Two points, four items.
  ScanId accept_scan(const std::string& key = {}) {
    const auto receipt = commit({new_scan(bench_plan({30}, {10, 20}, {90}), key)},
                                {{.kind = "scan-submitted", .who = "uid:1000", .json = "{}"}});
    EXPECT_TRUE(receipt) << describe(receipt.error());
    return receipt ? receipt->new_scan : 0;
  }

  NewAttempt attempt(ScanId scan, std::int32_t point, AttemptOutcome outcome = AttemptOutcome::Accepted) {
    return NewAttempt{.scan = scan,
                      .item = {.point = point, .target = Target::Sample},
                      .outcome = outcome,
                      .time = {.move = std::chrono::seconds(2), .expose = std::chrono::milliseconds(4)},
                      .readings = {reading_of(1000.0 + point, clock_.now())},
                      .started = clock_.now()};
  }

  std::int64_t count(const std::string& query) {
    SQLite::Database database(path_, SQLite::OPEN_READONLY);
    return database.execAndGet(query).getInt64();
  }

  test::ScratchFolder folder_;
  std::string path_ = folder_.file("store.sqlite");
  ManualClock clock_;
  std::unique_ptr<StoreWriter> writer_;
};

TEST_F(Store, AScanComesBackWithItsPointsTextsAndPolicy) {
  const ScanId id = accept_scan();

  const auto reader = open_reader();
  const auto info = reader->scan(id);
  const auto texts = reader->texts(id);
  const auto points = reader->points(id, -1, 10);

  ASSERT_TRUE(info && texts && points);
  EXPECT_EQ(info->name, "bench plan");
  EXPECT_EQ(info->campaign, "tests");
  EXPECT_EQ(info->state, ScanState::Queued);
  EXPECT_EQ(info->policy, policy_of(bench_plan({30}, {10, 20}, {90})));
  EXPECT_EQ(info->counts.points, 2);
  EXPECT_EQ(info->counts.items, 4);
  EXPECT_EQ(texts->plan, "[scan]\nname = \"bench plan\"\n");
  EXPECT_EQ(texts->plan_sha256, sha256_hex(texts->plan));
  ASSERT_EQ(points->size(), 2U);
  EXPECT_NEAR(in_degrees((*points)[1].point.geometry.theta_r), 20.0, 1e-12);
  EXPECT_EQ(reader->points(id, 0, 10)->size(), 1U);
}

TEST_F(Store, StatedExposuresComeBackWithTheScanAndAfterARestart) {
  api::Plan plan = bench_plan({30}, {10}, {90});
  plan.exposures = {std::chrono::milliseconds(1), std::chrono::milliseconds(32)};
  const auto receipt = commit({new_scan(plan)});
  ASSERT_TRUE(receipt) << describe(receipt.error());

  const auto info = open_reader()->scan(receipt->new_scan);
  const auto unfinished = writer_->unfinished();

  ASSERT_TRUE(info && unfinished);
  EXPECT_EQ(info->policy.exposures, plan.exposures);
  ASSERT_EQ(unfinished->size(), 1U);
  EXPECT_EQ(unfinished->front().policy, policy_of(plan));
}

TEST_F(Store, Sha256IsThatOfFips180) {
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST_F(Store, AScanThatIsNotThereIsNotFound) {
  const auto reader = open_reader();

  EXPECT_EQ(reader->scan(7).error().code, ErrorCode::NotFound);
  EXPECT_EQ(reader->texts(7).error().code, ErrorCode::NotFound);
  EXPECT_EQ(reader->readings(7, {}).error().code, ErrorCode::NotFound);
  EXPECT_EQ(reader->brdf(7).error().code, ErrorCode::NotFound);
}

TEST_F(Store, ASecondAcceptanceOfAnItemFailsAndWritesNothingOfItsTransaction) {
  const ScanId id = accept_scan();
  ASSERT_TRUE(commit({attempt(id, 0)}, {{.kind = "item-accepted", .scan = id, .json = "{}"}}));
  const auto before = open_reader()->last_event();

  const auto doubled = commit({attempt(id, 0)}, {{.kind = "item-accepted", .scan = id, .json = "{}"}});

  ASSERT_FALSE(doubled);
  EXPECT_EQ(doubled.error().code, ErrorCode::StoreFailed);
  EXPECT_EQ(open_reader()->last_event(), before);
  EXPECT_EQ(count("SELECT count(*) FROM attempt"), 1);
  EXPECT_EQ(count("SELECT count(*) FROM reading"), 1);
}

TEST_F(Store, ARetakeIsANewAttemptAndOverwritesNothing) {
  const ScanId id = accept_scan();
  NewAttempt failed = attempt(id, 0, AttemptOutcome::Failed);
  failed.error = Error{.code = ErrorCode::OutOfTolerance, .device = "stage"};

  ASSERT_TRUE(commit({failed}));
  ASSERT_TRUE(commit({attempt(id, 0)}));

  EXPECT_EQ(count("SELECT count(*) FROM attempt"), 2);
  EXPECT_EQ(count("SELECT max(number) FROM attempt"), 2);
  EXPECT_EQ(count("SELECT count(*) FROM attempt WHERE error_code = 'out-of-tolerance'"), 1);
  EXPECT_EQ(open_reader()->points(id, -1, 10)->front().attempts, 2);
}

TEST_F(Store, ANumberThatIsNotFiniteIsRefusedBeforeItIsBound) {
  const ScanId id = accept_scan();
  NewAttempt bad = attempt(id, 0);
  bad.readings[0].region.mean = std::numeric_limits<double>::quiet_NaN();

  const auto refused = commit({bad});

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(count("SELECT count(*) FROM attempt"), 0);
  EXPECT_TRUE(commit({attempt(id, 0)})) << "the store goes on after a refusal";
}

TEST_F(Store, EventsAreGaplessAcrossFailuresAndRuns) {
  const ScanId id = accept_scan();
  ASSERT_FALSE(commit({attempt(id, 99)}, {{.kind = "item-accepted", .scan = id, .json = "{}"}}));  // no such point
  ASSERT_TRUE(commit({attempt(id, 1)}, {{.kind = "item-accepted", .scan = id, .json = "{\"point\":1}"}}));
  writer_.reset();
  writer_ = open_writer();
  ASSERT_TRUE(commit({attempt(id, 0)}, {{.kind = "item-accepted", .scan = id, .json = "{\"point\":0}"}}));

  const auto events = open_reader()->events(0, 100, 0);

  ASSERT_TRUE(events);
  ASSERT_EQ(events->size(), 5U);
  for (std::size_t k = 0; k < events->size(); ++k) EXPECT_EQ((*events)[k].number, static_cast<std::int64_t>(k + 1));
  EXPECT_EQ((*events)[0].kind, "run-started");
  EXPECT_EQ((*events)[1].kind, "scan-submitted");
  EXPECT_EQ((*events)[1].scan, id);
  EXPECT_EQ((*events)[3].kind, "run-started");
  EXPECT_EQ(open_reader()->events(2, 100, id)->size(), 2U);
}

TEST_F(Store, ASecondDaemonIsRefusedWithThePidOfTheFirst) {
  const auto second = StoreWriter::open({.path = path_, .boot_id = "b", .version = "test"}, clock_);

  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::StoreLocked);
  EXPECT_NE(second.error().seen.find(std::to_string(getpid())), std::string::npos);
}

TEST_F(Store, AStoreOfALaterVersionIsRefusedByWriterAndReader) {
  writer_.reset();
  {
    SQLite::Database later(path_, SQLite::OPEN_READWRITE);
    later.exec("PRAGMA user_version = 99");
  }

  EXPECT_EQ(StoreWriter::open({.path = path_, .boot_id = "b", .version = "test"}, clock_).error().code,
            ErrorCode::StoreTooNew);
  EXPECT_EQ(StoreReader::open(path_).error().code, ErrorCode::StoreTooNew);
}

TEST_F(Store, AReaderOfAFileThatIsNotThereFails) {
  EXPECT_EQ(StoreReader::open(folder_.file("nothing.sqlite")).error().code, ErrorCode::StoreFailed);
}

TEST_F(Store, CommitsAreDurableByWalAndFullSynchronisation) {
  EXPECT_EQ(count("SELECT count(*) FROM pragma_journal_mode WHERE journal_mode = 'wal'"), 1);
}

TEST_F(Store, AKnownIdempotencyKeyNamesItsScanAndWritesNothing) {
  const ScanId first = accept_scan("key-1");
  const auto events = open_reader()->last_event();

  const auto again =
      commit({new_scan(bench_plan({30}, {40}, {90}), "key-1")}, {{.kind = "scan-submitted", .json = "{}"}});

  ASSERT_TRUE(again);
  EXPECT_TRUE(again->existed);
  EXPECT_EQ(again->new_scan, first);
  EXPECT_TRUE(again->events.empty());
  EXPECT_EQ(open_reader()->last_event(), events);
  EXPECT_EQ(open_reader()->scans(0, 10)->size(), 1U);
}

TEST_F(Store, AStateChangesOnlyFromTheStateBelievedIn) {
  const ScanId id = accept_scan();

  const auto wrong = commit({ScanTransition{.scan = id, .from = ScanState::Running, .to = ScanState::Holding}});
  const auto right = commit({ScanTransition{.scan = id, .from = ScanState::Queued, .to = ScanState::Preparing}});

  EXPECT_FALSE(wrong);
  EXPECT_TRUE(right);
  EXPECT_EQ(open_reader()->scan(id)->state, ScanState::Preparing);
}

TEST_F(Store, HoldsStandUntilClearedAndAreNotDoubled) {
  const ScanId id = accept_scan();
  const AddHold lamp{.scan = id, .hold = {.name = HoldName::Lamp, .owner = "stage", .reason = "monitor 0.01"}};
  ASSERT_TRUE(commit({lamp, lamp, AddHold{.scan = id, .hold = {.name = HoldName::Operator, .owner = "uid:1"}}}));
  EXPECT_EQ(open_reader()->scan(id)->holds.size(), 2U);

  ASSERT_TRUE(commit({ClearHolds{.scan = id, .who = "uid:1"}}));

  EXPECT_TRUE(open_reader()->scan(id)->holds.empty());
  EXPECT_EQ(count("SELECT count(*) FROM hold"), 2) << "cleared, kept";
}

TEST_F(Store, ReadingsComeBackGroupedWithAnglesFromCountsAndWithoutProbes) {
  const ScanId id = accept_scan();
  drivers::StageConfig stage = test::bench_instrument().stage;
  NewAttempt taken = attempt(id, 1);
  taken.readings = {reading_of(4000, clock_.now()), reading_of(1000, clock_.now()), reading_of(1010, clock_.now())};
  taken.readings[0].used = false;
  taken.readings[1].open_counts[stage::index_of(stage::Axis::ThetaR)] = 200100;  // own map: 1e-4 deg a count
  NewVisit dark{.scan = id,
                .readings = {reading_of(100, clock_.now(), std::chrono::milliseconds(1)),
                             reading_of(101, clock_.now(), std::chrono::milliseconds(2))}};
  ASSERT_TRUE(commit({dark}));
  ASSERT_TRUE(commit({attempt(id, 0, AttemptOutcome::Failed)}));
  ASSERT_TRUE(commit({taken}));

  const auto readings = open_reader()->readings(id, stage);

  ASSERT_TRUE(readings) << describe(readings.error());
  EXPECT_EQ(readings->points.size(), 2U);
  ASSERT_EQ(readings->readings.size(), 3U) << "two dark exposures, one sample";
  const auto& sample = readings->readings[2];
  EXPECT_EQ(sample.target, Target::Sample);
  EXPECT_EQ(sample.point_index, 1);
  ASSERT_EQ(sample.frames.size(), 2U);
  EXPECT_EQ(sample.frames[0].region.mean, 1000.0);
  EXPECT_NEAR(in_degrees(sample.frames[0].at_open.theta_r), 20.01, 1e-9);
  EXPECT_NEAR(in_nanometres(sample.wavelength), 568.0, 1e-9);
  EXPECT_EQ(sample.visit_id % 2, 0);
  EXPECT_EQ(readings->readings[0].target, Target::Dark);
  EXPECT_EQ(readings->readings[0].visit_id % 2, 1);
  EXPECT_EQ(readings->readings[0].visit_id, readings->readings[1].visit_id);
}

TEST_F(Store, AReadingWhoseStatedExposuresWereSaturatedSaysSoAndAProbeIsNoPartOfIt) {
  for (const bool is_stated : {true, false}) {
    NewScan scan = new_scan(bench_plan({30}, {10, 20}, {90}), is_stated ? "stated" : "chosen");
    if (is_stated) scan.policy.exposures = {std::chrono::milliseconds(1), std::chrono::milliseconds(4)};
    const auto receipt = commit({scan});
    ASSERT_TRUE(receipt) << describe(receipt.error());
    NewAttempt taken = attempt(receipt->new_scan, 1);
    taken.readings = {reading_of(4000, clock_.now()), reading_of(1000, clock_.now())};
    taken.readings[0].used = false;
    taken.readings[0].region.saturated = 5;
    ASSERT_TRUE(commit({taken}));
    ASSERT_TRUE(commit({attempt(receipt->new_scan, 0)}));

    const auto readings = open_reader()->readings(receipt->new_scan, test::bench_instrument().stage);

    ASSERT_TRUE(readings) << describe(readings.error());
    ASSERT_EQ(readings->readings.size(), 2U);
    for (const auto& reading : readings->readings) {
      EXPECT_EQ(reading.has_saturated, is_stated && reading.point_index == 1);
    }
  }
}

TEST_F(Store, TheNewestBrdfComesBackWithItsSensitivities) {
  const ScanId id = accept_scan();
  const NewBrdf first{.scan = id, .code_version = "1", .inputs_json = "{}", .component_names = {"certificate"}};
  NewBrdf second = first;
  second.code_version = "2";
  second.component_names = {"certificate", "zero of theta_r"};
  second.rows = {BrdfRow{.point = 1,
                         .value_per_sr = 0.31,
                         .u_random_per_sr = 0.001,
                         .effective_dof = std::numeric_limits<double>::infinity(),
                         .flags = 5,
                         .reported = {.theta_i = degrees(30.001)},
                         .sensitivities_per_sr = {0.002, -0.003}}};
  ASSERT_TRUE(commit({first}));
  ASSERT_TRUE(commit({second}));

  const auto brdf = open_reader()->brdf(id);

  ASSERT_TRUE(brdf) << describe(brdf.error());
  EXPECT_EQ(brdf->code_version, "2");
  EXPECT_EQ(brdf->component_names, second.component_names);
  ASSERT_EQ(brdf->rows.size(), 1U);
  EXPECT_EQ(brdf->rows[0].sensitivities_per_sr, second.rows[0].sensitivities_per_sr);
  EXPECT_TRUE(std::isinf(brdf->rows[0].effective_dof));
  EXPECT_EQ(brdf->rows[0].flags, 5U);
  EXPECT_TRUE(brdf->sizes_only.empty());
  EXPECT_FALSE(brdf->rows[0].interval.has_value());
}

TEST_F(Store, ABrdfKeepsLopsidedIntervalsAndWhichComponentsHaveNoKnownSign) {
  const ScanId id = accept_scan();
  const StoredInterval lopsided{.u_per_sr = 0.011, .below_per_sr = 0.02, .above_per_sr = 0.03};
  const NewBrdf written{
      .scan = id,
      .code_version = "1",
      .inputs_json = "{}",
      .component_names = {"certificate", "zero of theta_r", "zero of theta_r through slopes"},
      .rows = {BrdfRow{.point = 0, .value_per_sr = 0.31, .sensitivities_per_sr = {0.0, 0.01}},
               BrdfRow{.point = 1, .value_per_sr = 0.32, .sensitivities_per_sr = {0.0, 0.01}, .interval = lopsided}},
      .sizes_only = {2}};
  ASSERT_TRUE(commit({written}));

  const auto brdf = open_reader()->brdf(id);

  ASSERT_TRUE(brdf) << describe(brdf.error());
  EXPECT_EQ(brdf->sizes_only, written.sizes_only);
  ASSERT_EQ(brdf->rows.size(), 2U);
  EXPECT_FALSE(brdf->rows[0].interval.has_value());
  EXPECT_EQ(brdf->rows[1].interval, lopsided);
}

TEST_F(Store, WhatIsNotOverIsRestoredWithItsDecisionsAndDebts) {
  const ScanId id = accept_scan();
  ASSERT_TRUE(commit({NewVisit{.scan = id, .time = {.expose = std::chrono::seconds(1)}}}));
  ASSERT_TRUE(commit({attempt(id, 0)}));
  ASSERT_TRUE(commit({attempt(id, 1, AttemptOutcome::Failed)}));
  ASSERT_TRUE(commit({SkipItem{.scan = id, .item = {1, Target::Reference}, .who = "uid:1", .reason = "asked"}}));

  const auto unfinished = open_reader()->unfinished(clock_.now(), clock_.utc_now());

  ASSERT_TRUE(unfinished) << describe(unfinished.error());
  ASSERT_EQ(unfinished->size(), 1U);
  const UnfinishedScan& scan = unfinished->front();
  EXPECT_EQ(scan.id, id);
  EXPECT_EQ(scan.accepted, (std::vector<ItemKey>{{0, Target::Sample}}));
  EXPECT_EQ(scan.skipped, (std::vector<ItemKey>{{1, Target::Reference}}));
  ASSERT_EQ(scan.attempts.size(), 1U);
  EXPECT_EQ(scan.attempts[0], std::pair(ItemKey{1, Target::Sample}, 1));
  EXPECT_EQ(scan.exposures_used, (std::vector<Duration>{std::chrono::milliseconds(4)}));
  EXPECT_TRUE(scan.dark_owed);
  EXPECT_EQ(scan.order.size(), 2U);
  EXPECT_EQ(scan.spent.move, std::chrono::seconds(4));

  ASSERT_TRUE(commit({NewVisit{.scan = id}}));
  EXPECT_FALSE(open_reader()->unfinished(clock_.now(), clock_.utc_now())->front().dark_owed);
  ASSERT_TRUE(commit({ScanTransition{.scan = id, .from = ScanState::Queued, .to = ScanState::Aborted}}));
  EXPECT_TRUE(open_reader()->unfinished(clock_.now(), clock_.utc_now())->empty());
}

TEST_F(Store, TheActorAnswersEachRequestWithItsTicket) {
  StoreActor actor(*writer_);

  const auto committed =
      actor.on(Commit{.ticket = 7, .transaction = {.writes = {new_scan(bench_plan({30}, {10}, {90}))}}}, clock_.now());
  const auto loaded = actor.on(LoadUnfinished{.ticket = 8}, clock_.now());

  ASSERT_TRUE(std::holds_alternative<CommitAnswer>(committed));
  EXPECT_EQ(std::get<CommitAnswer>(committed).ticket, 7U);
  EXPECT_EQ(std::get<CommitAnswer>(committed).receipt->new_scan, 1);
  ASSERT_TRUE(std::holds_alternative<UnfinishedAnswer>(loaded));
  EXPECT_EQ(std::get<UnfinishedAnswer>(loaded).scans->size(), 1U);
}

TEST_F(Store, NamesOfStatesHoldsAndTargetsGoBothWays) {
  for (const ScanState s : kAllScanStates) EXPECT_EQ(scan_state_from_name(scan_state_name(s)), s);
  for (const HoldName h :
       {HoldName::Operator, HoldName::Lamp, HoldName::Door, HoldName::Device, HoldName::Disk, HoldName::Restart}) {
    EXPECT_EQ(hold_from_name(hold_name(h)), h);
  }
  EXPECT_EQ(target_from_name("reference"), Target::Reference);
  EXPECT_EQ(scan_state_from_name("asleep"), std::nullopt);
}

TEST_F(Store, GivesBackWhatARadiometerSaidAndKeepsTheMonitorsWordBesideIt) {
  const ScanId id = accept_scan();
  NewAttempt made = attempt(id, 0);
  const auto power = [&](double watts, double range_w) {
    return PowerRecord{.reading = {.mean_w = watts,
                                   .standard_error_w = 1e-9,
                                   .samples = 10,
                                   .averages = 3,
                                   .range_w = range_w,
                                   .wavelength = nanometres(568.0)},
                       .started = clock_.now(),
                       .ended = clock_.now() + std::chrono::milliseconds(30)};
  };
  made.readings[0].power = power(2e-5, 1e-4);
  made.readings[0].monitor_power = power(1e-3, 1e-2);
  ASSERT_TRUE(commit({made}));

  const auto readings = open_reader()->readings(id, test::bench_instrument().stage);

  ASSERT_TRUE(readings) << describe(readings.error());
  ASSERT_EQ(readings->readings.size(), 1U);
  EXPECT_EQ(readings->readings[0].frames.at(0).power, made.readings[0].power->reading);
  EXPECT_EQ(count("SELECT ended_boottime_ns - started_boottime_ns FROM power_reading WHERE role = 'monitor' AND "
                  "mean_w = 1e-3 AND range_w = 1e-2"),
            30'000'000);
}

PixelSumRecord sums_of(Duration exposure, double first, double second) {
  return std::make_shared<calibration::PixelSums>(
      calibration::PixelSums{.box = {.width = 4, .height = 3, .left = 1, .top = 2, .columns = 2, .rows = 1},
                             .exposure = exposure,
                             .frames = 2,
                             .sum = {first + second, 2.0 * first},
                             .sum2 = {first * first + second * second, 2.0 * first * first}});
}

TEST_F(Store, KeepsSumsOfFramesWithTheirReadingsAndJoinsThoseOfAnExposure) {
  using std::chrono::milliseconds;
  const ScanId scan = accept_scan();
  for (const std::int32_t point : {0, 1}) {
    NewAttempt lit = attempt(scan, point);
    lit.pixel_sums = {sums_of(milliseconds(4), 10.0, 14.0), sums_of(milliseconds(8), 20.0, 22.0)};
    ASSERT_TRUE(commit({lit}));
  }
  NewVisit dark{.scan = scan, .readings = {reading_of(100.0, clock_.now())}, .started = clock_.now()};
  dark.pixel_sums = {sums_of(milliseconds(4), 1.0, 3.0)};
  ASSERT_TRUE(commit({dark}));
  NewAttempt doubled = attempt(scan, 0);
  doubled.pixel_sums = {sums_of(milliseconds(4), 10.0, 14.0)};
  EXPECT_FALSE(commit({doubled})) << "accepted already: its sums go with it";

  const auto stacks = open_reader()->pixel_stacks(scan);

  ASSERT_TRUE(stacks) << describe(stacks.error());
  ASSERT_EQ(stacks->lit.size(), 2U);
  EXPECT_EQ(stacks->lit[0].exposure(), milliseconds(4));
  EXPECT_EQ(stacks->lit[0].frames(), 4);
  EXPECT_EQ(stacks->lit[0].degrees_of_freedom(), 2);
  EXPECT_EQ(stacks->lit[0].mean(0), 12.0);
  EXPECT_EQ(stacks->lit[0].variance(0), 8.0) << "(10 - 12)^2 + (14 - 12)^2, twice, of two degrees of freedom";
  EXPECT_EQ(stacks->lit[0].variance(1), 0.0);
  EXPECT_EQ(stacks->lit[1].mean(0), 21.0);
  EXPECT_EQ(stacks->lit[0].box(),
            (calibration::PixelBox{.width = 4, .height = 3, .left = 1, .top = 2, .columns = 2, .rows = 1}));
  ASSERT_EQ(stacks->dark.size(), 1U);
  EXPECT_EQ(stacks->dark[0].mean(0), 2.0);
  EXPECT_TRUE(open_reader()->pixel_stacks(scan + 1)->dark.empty());
}

}  // namespace
}  // namespace gonio::daemon
