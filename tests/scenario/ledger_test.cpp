// The ledger of the kill test must notice what it is there to notice.
#include "tests/scenario/ledger.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/process.h"

namespace gonio::test {
namespace {

constexpr long kScan = 1;

// As much of the store's tables as the ledger reads: two points, the first of them accepted on the sample with one
// reading, and three events.
class LedgerOfASmallStore : public testing::Test {
 protected:
  LedgerOfASmallStore() {
    SQLite::Database store(file_, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    store.exec(
        "CREATE TABLE event(number INTEGER PRIMARY KEY);"
        "CREATE TABLE point(scan_id INTEGER, point_index INTEGER, theta_i_deg REAL, theta_r_deg REAL, phi_r_deg REAL);"
        "CREATE TABLE attempt(attempt_id INTEGER PRIMARY KEY, point_index INTEGER, target TEXT, number INTEGER);"
        "CREATE TABLE item(point_index INTEGER, target TEXT, outcome TEXT, attempt_id INTEGER);"
        "CREATE VIEW decided_item AS SELECT * FROM item;"
        "CREATE TABLE reading(attempt_id INTEGER, sequence INTEGER, mean_dn REAL);"
        "INSERT INTO event VALUES (1), (2), (3);"
        "INSERT INTO point VALUES (1, 0, 10, 0, 60), (1, 1, 10, 20, 60);"
        "INSERT INTO attempt VALUES (1, 0, 'sample', 1);"
        "INSERT INTO item VALUES (0, 'sample', 'accepted', 1);"
        "INSERT INTO reading VALUES (1, 0, 1000.25);");
  }

  void change(const std::string& statement) { SQLite::Database(file_, SQLite::OPEN_READWRITE).exec(statement); }
  [[nodiscard]] StoreCopy store() const { return {file_, folder_.path()}; }

  // One exposure of the accepted item, and `more` of the other point.
  static SeenExposures seen(long more = 0) {
    SeenExposures exposures{.total = 1 + more, .lit = {{"sample", 10.0, 0.0, 60.0, 1}}};
    if (more > 0) exposures.lit.push_back({"sample", 10.0, 20.0, 60.0, more});
    return exposures;
  }

  TemporaryFolder folder_;
  std::string file_ = folder_ / "store.sqlite";
  Ledger ledger_{kScan};
};

TEST_F(LedgerOfASmallStore, AcceptsWhatIsAsItWasWithOneItemExposedInVain) {
  ledger_.inspect(store(), seen());
  ledger_.inspect(store(), seen(3));

  EXPECT_EQ(ledger_.items_exposed_again(), 1);
  EXPECT_EQ(ledger_.exposures_in_vain(), 3);
}

TEST_F(LedgerOfASmallStore, NoticesALostItem) {
  ledger_.inspect(store(), seen());
  change("DELETE FROM item");
  EXPECT_NONFATAL_FAILURE(ledger_.inspect(store(), seen()), "item 0 sample is lost");
}

TEST_F(LedgerOfASmallStore, NoticesTheLastBitOfAReading) {
  ledger_.inspect(store(), seen());
  change("UPDATE reading SET mean_dn = 1000.2500000000001");
  EXPECT_NONFATAL_FAILURE(ledger_.inspect(store(), seen()), "item 0 sample has changed");
}

TEST_F(LedgerOfASmallStore, NoticesAGapInTheEvents) {
  change("DELETE FROM event WHERE number = 2");
  EXPECT_NONFATAL_FAILURE(ledger_.inspect(store(), seen()), "events have a gap");
}

TEST_F(LedgerOfASmallStore, NoticesTwoItemsExposedInVainByOneKill) {
  ledger_.inspect(store(), seen());
  SeenExposures exposures = seen(1);
  exposures.total += 1;
  exposures.dark = 1;
  EXPECT_NONFATAL_FAILURE(ledger_.inspect(store(), exposures), "one kill may cost one item");
}

TEST_F(LedgerOfASmallStore, AllowsAnItemForEachOfTheKillsSinceItLastLooked) {
  ledger_.inspect(store(), seen());
  SeenExposures exposures = seen(1);
  exposures.total += 1;
  exposures.dark = 1;

  ledger_.inspect(store(), exposures, 2);

  EXPECT_EQ(ledger_.items_exposed_again(), 2);
}

TEST_F(LedgerOfASmallStore, NoticesAnAcceptanceThatWasToldAndIsNotThere) {
  ledger_.hear({{1, "item-accepted", R"({"data":{"point":1,"target":"sample"}})"}});
  EXPECT_NONFATAL_FAILURE(ledger_.inspect(store(), seen()), "item 1 sample was told");
}

TEST_F(LedgerOfASmallStore, NoticesAnItemThatIsAcceptedTwice) {
  const ServerEvent accepted{1, "item-accepted", R"({"data":{"point":1,"target":"sample"}})"};
  const ServerEvent again{2, accepted.kind, accepted.data};
  EXPECT_NONFATAL_FAILURE(ledger_.expect_retold({accepted, again}), "accepted more than once");
}

TEST_F(LedgerOfASmallStore, NoticesEventsThatAreRetoldOtherwise) {
  ledger_.hear({{1, "scan-running", "{}"}});
  EXPECT_NONFATAL_FAILURE(ledger_.expect_retold({{1, "scan-running", "{ }"}}), "event 1");
}

}  // namespace
}  // namespace gonio::test
