// A disk that is full or fails, a database that somebody else holds: the scan holds by name, and afterwards nothing is
// lost or doubled.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "tests/daemon/sequencer/scan_rig.h"
#include "tests/support/power_cut_disk.h"

namespace gonio::daemon {
namespace {

using gonio::test::DiskOperation;
using gonio::test::PowerCutDisk;
using test::bench_plan;
using test::ScanRig;
using test::ScratchFolder;

api::Plan troubled_plan() {
  api::Plan plan = bench_plan({30}, {10, 20}, {90});
  plan.target_snr = 200;
  plan.max_time = std::chrono::milliseconds(2);
  return plan;
}
constexpr std::int64_t kItems = 4;

class StoreTrouble : public testing::Test {
 protected:
  const ScratchFolder folder_;
  PowerCutDisk disk_;
  ScanRig rig_{test::bench_instrument(), folder_.file("store.sqlite")};
  ScanId id_ = rig_.submit(troubled_plan());

  // Operations of this kind fail from the one after next on.
  void fail_from(int code, DiskOperation kind, int passing) {
    disk_.refuse(code, [kind, passing](DiskOperation operation, const std::string&) mutable {
      return operation == kind && --passing < 0;
    });
  }

  bool is_on_hold(HoldName name) {
    const auto active = rig_.status().active;
    return active && std::ranges::any_of(active->holds, [name](const Hold& hold) { return hold.name == name; });
  }

  void resume_and_expect_each_item_once() {
    rig_.command(ResumeScan{id_});
    rig_.run_to_rest();
    EXPECT_EQ(rig_.state_of(id_), ScanState::Done);
    EXPECT_EQ(rig_.count("SELECT count(*) FROM item WHERE outcome = 'accepted'"), kItems);
    EXPECT_EQ(rig_.count("SELECT count(*) FROM attempt WHERE outcome = 'accepted'"), kItems);
    EXPECT_EQ(rig_.count("SELECT count(*) FROM event WHERE kind = 'item-accepted'"), kItems);
    EXPECT_EQ(rig_.count("SELECT count(*) FROM event"), rig_.count("SELECT max(number) FROM event"));
    SQLite::Database database(rig_.store_path(), SQLite::OPEN_READONLY);
    EXPECT_EQ(database.execAndGet("PRAGMA integrity_check").getString(), "ok");
    for (const EventRecord& heard : rig_.events) {
      SQLite::Statement kept(database, "SELECT json FROM event WHERE number = ?");
      kept.bind(1, heard.number);
      ASSERT_TRUE(kept.executeStep()) << "event " << heard.number << " was told";
      EXPECT_EQ(kept.getColumn(0).getString(), heard.json);
    }
  }
};

struct Trouble {
  std::string name;
  int code = SQLITE_OK;
  DiskOperation operation = DiskOperation::Write;
  ErrorCode told = ErrorCode::StoreFailed;
};

std::ostream& operator<<(std::ostream& out, const Trouble& trouble) {
  return out << trouble.name;
}

class StoreTroubleOfTheDisk : public StoreTrouble, public testing::WithParamInterface<Trouble> {};

const std::vector<Trouble> kTroubles{{"full", SQLITE_FULL, DiskOperation::Write, ErrorCode::DiskFull},
                                     {"failing", SQLITE_IOERR, DiskOperation::Write, ErrorCode::StoreFailed},
                                     {"not_syncing", SQLITE_IOERR_FSYNC, DiskOperation::Sync, ErrorCode::StoreFailed}};
INSTANTIATE_TEST_SUITE_P(Kinds, StoreTroubleOfTheDisk, testing::ValuesIn(kTroubles),
                         [](const testing::TestParamInfo<Trouble>& trouble) { return trouble.param.name; });

TEST_P(StoreTroubleOfTheDisk, HoldsTheScanByNameAtWhateverCommitItComes) {
  const Trouble& trouble = GetParam();
  const std::int64_t accepted_before = rig_.count("SELECT count(*) FROM item");
  fail_from(trouble.code, trouble.operation, 0);
  rig_.run_to_rest();

  ASSERT_TRUE(is_on_hold(HoldName::Disk));
  ASSERT_TRUE(rig_.status().store_error);
  EXPECT_EQ(rig_.status().store_error->code, trouble.told);
  EXPECT_EQ(rig_.count("SELECT count(*) FROM item"), accepted_before);

  rig_.command(ResumeScan{id_});
  rig_.run_to_rest();
  EXPECT_TRUE(is_on_hold(HoldName::Disk)) << "a resume while it lasts changes nothing";

  disk_.refuse(SQLITE_OK, {});
  resume_and_expect_each_item_once();
}

TEST_P(StoreTroubleOfTheDisk, ComesAndGoesThroughAWholeScanWithoutLoss) {
  const Trouble& trouble = GetParam();
  // Each time a little later: every commit of the scan meets it once, at its first operation or in its midst.
  for (int passing = 0; passing < 40 && rig_.state_of(id_) != ScanState::Done; ++passing) {
    SCOPED_TRACE("after " + std::to_string(passing) + " operations");
    fail_from(trouble.code, trouble.operation, passing);
    rig_.run_to_rest();
    if (rig_.state_of(id_) == ScanState::Done) break;
    ASSERT_TRUE(is_on_hold(HoldName::Disk));
    disk_.refuse(SQLITE_OK, {});
    if (passing % 3 == 2) {
      rig_.kill();
      rig_.start();
    } else {
      rig_.command(ResumeScan{id_});
    }
    // The store is read again before anything else can fail.
    rig_.run_until([this] { return !rig_.status().store_error && rig_.status().active; });
  }
  disk_.refuse(SQLITE_OK, {});

  resume_and_expect_each_item_once();
}

TEST_F(StoreTrouble, AForeignWriterThatDoesNotLetGoHoldsTheScanAndOneThatDoesCostsNothing) {
  SQLite::Database foreign(rig_.store_path(), SQLite::OPEN_READWRITE);
  foreign.exec("BEGIN IMMEDIATE");
  rig_.run_to_rest();

  ASSERT_TRUE(is_on_hold(HoldName::Disk));
  EXPECT_NE(rig_.status().store_error->seen.find("locked"), std::string::npos) << describe(*rig_.status().store_error);

  // It lets go while the next commit waits.
  int pauses = 0;
  disk_.while_waiting([&] {
    if (++pauses == 3) foreign.exec("ROLLBACK");
  });
  resume_and_expect_each_item_once();
  EXPECT_EQ(pauses, 3);
}

TEST_F(StoreTrouble, AReaderThatStaysInItsTransactionDelaysNothing) {
  disk_.while_waiting([] { ADD_FAILURE() << "the writer waits for a reader"; });
  SQLite::Database reader(rig_.store_path(), SQLite::OPEN_READONLY);
  reader.exec("BEGIN");
  const auto seen_items = [&reader] { return reader.execAndGet("SELECT count(*) FROM item").getInt64(); };
  ASSERT_EQ(seen_items(), 0);

  rig_.run_to_rest();

  EXPECT_EQ(rig_.state_of(id_), ScanState::Done);
  EXPECT_EQ(rig_.count("SELECT count(*) FROM item WHERE outcome = 'accepted'"), kItems);
  EXPECT_EQ(seen_items(), 0) << "its own moment";
  reader.exec("COMMIT");
  EXPECT_EQ(seen_items(), kItems);
}

}  // namespace
}  // namespace gonio::daemon
