#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "daemon/store/store_reader.h"
#include "daemon/store/store_writer.h"
#include "tests/daemon/support/scan_records.h"

namespace gonio::daemon {
namespace {

using std::chrono::minutes;

class ScanChanges : public testing::Test {
 protected:
  ScanChanges() {
    writer_ = std::move(StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_)).value();
    reader_ = std::move(StoreReader::open(path_)).value();
  }

  ScanId write(StoreWrite record) {
    const auto receipt = writer_->commit({.at = clock_.now(), .writes = {std::move(record)}, .events = {}});
    EXPECT_TRUE(receipt) << describe(receipt.error());
    return receipt ? receipt->new_scan : 0;
  }

  ScanId accept(ScanTurn turn = {}) {
    NewScan scan = test::new_scan(test::bench_plan({30}, {10, 20, 40, 50}, {90}));
    scan.turn = turn;
    return write(scan);
  }

  UnfinishedScan unfinished(ScanId id) {
    const auto scans = writer_->unfinished().value();
    const auto found = std::find_if(scans.begin(), scans.end(), [id](const auto& s) { return s.id == id; });
    return found == scans.end() ? UnfinishedScan{} : *found;
  }

  test::ScratchFolder folder_;
  std::string path_ = folder_.file("store.sqlite");
  ManualClock clock_;
  std::unique_ptr<StoreWriter> writer_;
  std::unique_ptr<StoreReader> reader_;
};

TEST_F(ScanChanges, KeepAScansTurnAndCarryItsStartIntoTheNextBoot) {
  const ScanId first = accept();
  const ScanTurn::Start start{.at = clock_.now() + minutes(30), .utc = clock_.utc_now() + minutes(30)};

  const ScanId id = accept({.priority = 7, .preempts = true, .start = start, .completes = first});
  clock_.advance(minutes(10));

  const ScanTurn turn = unfinished(id).turn;
  EXPECT_EQ(turn.priority, 7);
  EXPECT_TRUE(turn.preempts);
  ASSERT_TRUE(turn.start);
  EXPECT_EQ(turn.start->at - clock_.now(), minutes(20));
  EXPECT_EQ(turn.completes, first);
  EXPECT_EQ(reader_->scan(first)->completed_by, id);
  EXPECT_EQ(reader_->scan(id)->turn.start->utc, start.utc);
}

TEST_F(ScanChanges, ClearOneHoldAndLeaveTheOther) {
  const ScanId id = accept();
  write(AddHold{.scan = id, .hold = {.name = HoldName::Operator, .owner = "uid:7"}});
  write(AddHold{.scan = id, .hold = {.name = HoldName::Lamp, .owner = "stage"}});

  write(ClearHolds{.scan = id, .who = "uid:7", .names = {HoldName::Operator}});

  ASSERT_EQ(unfinished(id).holds.size(), 1U);
  EXPECT_EQ(unfinished(id).holds[0].name, HoldName::Lamp);
}

TEST_F(ScanChanges, ReplaceExposureLimitsPriorityAndStart) {
  const ScanId id = accept();

  write(ScanChange{.scan = id, .target_snr = 50.0, .max_time = std::chrono::seconds(3), .priority = -2});

  EXPECT_EQ(unfinished(id).policy.target_snr, 50.0);
  EXPECT_EQ(unfinished(id).policy.max_time, std::chrono::seconds(3));
  EXPECT_EQ(unfinished(id).turn.priority, -2);
  EXPECT_FALSE(unfinished(id).turn.start);
}

TEST_F(ScanChanges, GiveTheRestItsOwnRanksInANewOrder) {
  const ScanId id = accept();
  const std::vector<std::int32_t> before = unfinished(id).order;
  ASSERT_EQ(before.size(), 4U);

  write(ScanChange{.scan = id, .order = {before[3], before[1], before[2]}});

  EXPECT_EQ(unfinished(id).order, (std::vector<std::int32_t>{before[0], before[3], before[1], before[2]}));
}

}  // namespace
}  // namespace gonio::daemon
