// Visits of the standard and the sample, and items that a drift opens again.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include <memory>

#include "daemon/store/store_reader.h"
#include "daemon/store/store_writer.h"
#include "tests/daemon/support/scan_records.h"

namespace gonio::daemon {
namespace {

using calibration::Target;
using test::bench_plan;
using test::new_scan;
using test::reading_of;

const ItemKey kFirstSample{0, Target::Sample};

class VisitStore : public testing::Test {
 protected:
  void SetUp() override {
    auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
    ASSERT_TRUE(writer) << describe(writer.error());
    writer_ = std::move(*writer);
    const auto receipt = commit(new_scan(bench_plan({30}, {10, 20}, {90})));
    ASSERT_TRUE(receipt) << describe(receipt.error());
    scan_ = receipt->new_scan;
  }

  Result<CommitReceipt> commit(StoreWrite write) {
    clock_.advance(std::chrono::milliseconds(100));
    return writer_->commit({.at = clock_.now(), .writes = {std::move(write)}});
  }
  NewAttempt accepted(const ItemKey& item, double mean_dn = 1000.0) {
    return {.scan = scan_, .item = item, .readings = {reading_of(mean_dn, clock_.now())}, .started = clock_.now()};
  }
  NewVisit reference_visit(double level, std::optional<double> drift = std::nullopt) {
    return {.scan = scan_,
            .readings = {reading_of(2000, clock_.now())},
            .started = clock_.now(),
            .kind = VisitKind::Reference,
            .level = VisitLevel{.point = 1, .level = level, .u_relative = 1e-3, .drift = drift}};
  }
  NewVisit reopening(std::vector<ItemKey> items) {
    NewVisit visit = reference_visit(5.1, 0.02);
    visit.reopened = std::move(items);
    return visit;
  }
  UnfinishedScan unfinished() {
    const auto scans = writer_->unfinished();
    EXPECT_TRUE(scans) << describe(scans.error());
    return scans->front();
  }
  std::int64_t count(const std::string& query) {
    SQLite::Database database(path_, SQLite::OPEN_READONLY);
    return database.execAndGet(query).getInt64();
  }

  test::ScratchFolder folder_;
  std::string path_ = folder_.file("store.sqlite");
  ManualClock clock_;
  std::unique_ptr<StoreWriter> writer_;
  ScanId scan_ = 0;
};

TEST_F(VisitStore, TheLastVisitComesBackWithWhatWasAcceptedAfterIt) {
  ASSERT_TRUE(commit(accepted(kFirstSample)));
  ASSERT_TRUE(commit(reference_visit(5.0)));
  ASSERT_TRUE(commit(reference_visit(5.01, 0.002)));
  ASSERT_TRUE(commit(accepted({1, Target::Sample})));

  const UnfinishedScan scan = unfinished();

  ASSERT_TRUE(scan.last_reference.level);
  EXPECT_EQ(scan.last_reference.level->point, 1);
  EXPECT_EQ(scan.last_reference.level->level, 5.01);
  EXPECT_EQ(scan.last_reference.since, (std::vector<ItemKey>{{1, Target::Sample}}));
  EXPECT_FALSE(scan.last_check.level);
  EXPECT_EQ(scan.last_check.since.size(), 2U) << "no check has judged them";
  EXPECT_EQ(scan.largest_drift, 0.002);
  EXPECT_TRUE(scan.dark_owed);
}

TEST_F(VisitStore, AReopenedItemIsOpenAndItsFirstRoundStays) {
  ASSERT_TRUE(commit(accepted(kFirstSample)));
  ASSERT_TRUE(commit(reopening({kFirstSample})));

  const UnfinishedScan scan = unfinished();

  EXPECT_TRUE(scan.accepted.empty());
  EXPECT_EQ(scan.reopened, (std::vector<std::pair<std::int32_t, int>>{{0, 1}}));
  EXPECT_TRUE(scan.last_reference.since.empty());
  EXPECT_EQ(count("SELECT count(*) FROM item WHERE outcome = 'accepted'"), 1);
  EXPECT_EQ(count("SELECT count(*) FROM attempt"), 1);
}

TEST_F(VisitStore, EachRoundTakesOneDecision) {
  ASSERT_TRUE(commit(accepted(kFirstSample)));
  EXPECT_FALSE(commit(accepted(kFirstSample)));
  ASSERT_TRUE(commit(reopening({kFirstSample})));

  EXPECT_TRUE(commit(accepted(kFirstSample)));
  EXPECT_FALSE(commit(accepted(kFirstSample)));

  EXPECT_EQ(count("SELECT count(*) FROM item"), 2);
  EXPECT_EQ(count("SELECT max(round) FROM decided_item"), 2);
  EXPECT_EQ(count("SELECT count(*) FROM decided_item"), 1);
}

TEST_F(VisitStore, WhatIsNotAcceptedIsNotReopenedAndTheVisitIsNotWritten) {
  ASSERT_TRUE(commit(accepted(kFirstSample)));

  const auto refused = commit(reopening({kFirstSample, {1, Target::Sample}}));

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::StoreFailed);
  EXPECT_EQ(count("SELECT count(*) FROM visit"), 0);
  EXPECT_EQ(count("SELECT count(*) FROM reopening"), 0);
}

TEST_F(VisitStore, TheLastAcceptedRoundIsWhatIsCalibrated) {
  ASSERT_TRUE(commit(accepted(kFirstSample, 1000.0)));
  ASSERT_TRUE(commit(reopening({kFirstSample})));
  auto reader = StoreReader::open(path_);
  ASSERT_TRUE(reader) << describe(reader.error());
  const auto sample_mean = [&] {
    const auto all = (*reader)->readings(scan_, test::bench_instrument().stage);
    EXPECT_TRUE(all) << describe(all.error());
    double mean = 0.0;
    for (const auto& reading : all->readings) {
      if (reading.point_index == 0) mean += reading.frames.front().region.mean;
    }
    return mean;
  };

  EXPECT_EQ(sample_mean(), 1000.0) << "until it is measured again";
  ASSERT_TRUE(commit(accepted(kFirstSample, 1100.0)));
  EXPECT_EQ(sample_mean(), 1100.0);
}

TEST_F(VisitStore, AVisitComesBackAsAReadingOfNoPoint) {
  ASSERT_TRUE(commit(reference_visit(5.0)));

  const auto reader = StoreReader::open(path_);
  const auto all = (*reader)->readings(scan_, test::bench_instrument().stage);

  ASSERT_TRUE(all) << describe(all.error());
  ASSERT_EQ(all->readings.size(), 1U);
  EXPECT_EQ(all->readings[0].target, Target::Reference);
  EXPECT_FALSE(all->readings[0].point_index);
  EXPECT_EQ(all->readings[0].visited_point, 1);
  EXPECT_NEAR(in_nanometres(all->readings[0].wavelength), 568.0, 1e-9);
}

TEST_F(VisitStore, TheSummaryCountsVisitsByKindAndPointsMeasuredAgain) {
  ASSERT_TRUE(commit(accepted(kFirstSample)));
  ASSERT_TRUE(commit(accepted({0, Target::Reference})));
  ASSERT_TRUE(commit(NewVisit{.scan = scan_}));
  ASSERT_TRUE(commit(reopening({kFirstSample, {0, Target::Reference}})));

  const auto info = (*StoreReader::open(path_))->scan(scan_);

  ASSERT_TRUE(info) << describe(info.error());
  EXPECT_EQ(info->counts.visits, 2);
  EXPECT_EQ(info->counts.reference_visits, 1);
  EXPECT_EQ(info->counts.check_visits, 0);
  EXPECT_EQ(info->counts.reopened, 1);
  EXPECT_EQ(info->counts.accepted, 0);
  EXPECT_EQ(info->largest_drift, 0.02);
}

}  // namespace
}  // namespace gonio::daemon
