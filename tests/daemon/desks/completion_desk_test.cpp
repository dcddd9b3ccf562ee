#include "daemon/desks/completion_desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "daemon/sequencer/scan_machine.h"
#include "daemon/store/store_writer.h"
#include "tests/daemon/support/scan_records.h"
#include "tests/support/process.h"

namespace gonio::daemon {
namespace {

using calibration::Target;
using testing::HasSubstr;

// A standard whose shape is 1 everywhere, within 85 deg.
std::string flat_standard() {
  std::string values;
  for (int i = 0; i < 3 * 3 * 2; ++i) values += "1.0,";
  return "[standard]\nserial = \"SRT-1\"\nmaterial = \"white\"\n[certificate]\ndate = 2025-11-03\nexpires = "
         "2027-11-03\n"
         "geometry = \"8/h\"\nspecular = \"included\"\ncoverage_factor = 2.0\nuncertainty_kind = \"absolute\"\n"
         "[[certificate.entries]]\nwavelength_nm = 568.0\nreflectance = 0.99\nuncertainty = 0.005\n"
         "[shape]\ntheta_i_deg = [0, 45, 85]\ntheta_r_deg = [0, 45, 85]\nphi_deg = [0, 180]\nvalues = [" +
         values + "]\nu_integral = 0.001\n";
}

class Completion : public testing::Test {
 protected:
  Completion() {
    gonio::test::write_text(standards_ / "a.toml", flat_standard());
    shelf_ = std::make_unique<ReferenceShelf>(standards_.path());
    writer_ = std::move(StoreWriter::open({.path = path_, .boot_id = "boot", .version = "test"}, clock_)).value();
    reader_ = std::move(StoreReader::open(path_)).value();
    scan_ = write({test::new_scan(test::bench_plan({30}, {10, 20, 40}, {90}))});
  }

  ScanId write(std::vector<StoreWrite> writes) {
    const auto receipt = writer_->commit({.at = clock_.now(), .writes = std::move(writes), .events = {}});
    EXPECT_TRUE(receipt) << describe(receipt.error());
    return receipt ? receipt->new_scan : 0;
  }
  void accept(std::int32_t point, Target target) {
    write({NewAttempt{.scan = scan_,
                      .item = {point, target},
                      .readings = {test::reading_of(1000.0, clock_.now())},
                      .started = clock_.now()}});
  }
  void go(ScanId scan, std::vector<ScanState> states) {
    ScanState from = ScanState::Queued;
    for (const ScanState to : states) {
      write({ScanTransition{.scan = scan, .from = from, .to = to, .who = "test", .reason = "test"}});
      from = to;
    }
  }
  Result<NewScan> complete(ScanId scan) {
    const UtcTime day{std::chrono::sys_days(std::chrono::year(2026) / 11 / 22)};
    return completion_of(*reader_, scan, test::bench_instrument(), *shelf_, day, "uid:7");
  }

  gonio::test::TemporaryFolder standards_;
  test::ScratchFolder folder_;
  std::string path_ = folder_.file("store.sqlite");
  ManualClock clock_;
  std::unique_ptr<ReferenceShelf> shelf_;
  std::unique_ptr<StoreWriter> writer_;
  std::unique_ptr<StoreReader> reader_;
  ScanId scan_ = 0;
};

TEST_F(Completion, HasThePointsThatLackSampleOrReferenceInTheOrderOfTheFirst) {
  const auto points = reader_->points(scan_, -1, 10).value();
  accept(0, Target::Sample);
  accept(0, Target::Reference);
  accept(1, Target::Sample);
  write({SkipItem{.scan = scan_, .item = {1, Target::Reference}, .who = "test"}});
  go(scan_, {ScanState::Preparing, ScanState::Running, ScanState::Finishing, ScanState::FinishedEarly});

  const Result<NewScan> rest = complete(scan_);

  ASSERT_TRUE(rest) << describe(rest.error());
  EXPECT_EQ(rest->turn.completes, scan_);
  EXPECT_EQ(rest->who, "uid:7");
  EXPECT_EQ(rest->policy, reader_->scan(scan_)->policy);
  ASSERT_EQ(rest->planned.points.size(), 2U);
  EXPECT_EQ(in_degrees(rest->planned.points[0].geometry.theta_r), in_degrees(points[1].point.geometry.theta_r));
  EXPECT_EQ(in_degrees(rest->planned.points[1].geometry.theta_r), in_degrees(points[2].point.geometry.theta_r));
  const bool same_order = points[1].point.rank < points[2].point.rank;
  EXPECT_EQ(rest->planned.order, same_order ? (std::vector<std::int32_t>{0, 1}) : (std::vector<std::int32_t>{1, 0}));
  EXPECT_EQ(rest->planned.items, 4);
}

TEST_F(Completion, IsRefusedInEveryStateThatIsNotAnEndAndSaysWhatIsTaken) {
  const std::vector<std::vector<ScanState>> ways{
      {},
      {ScanState::Preparing},
      {ScanState::Preparing, ScanState::Running},
      {ScanState::Preparing, ScanState::Holding},
      {ScanState::Preparing, ScanState::Running, ScanState::Finishing},
      {ScanState::Preparing, ScanState::Interrupted},
  };
  for (const auto& way : ways) {
    scan_ = write({test::new_scan(test::bench_plan({30}, {10}, {90}))});
    go(scan_, way);
    const Result<NewScan> rest = complete(scan_);
    ASSERT_FALSE(rest);
    EXPECT_EQ(rest.error().code, ErrorCode::WrongState);
    EXPECT_THAT(rest.error().seen, HasSubstr(std::string(scan_state_name(reader_->scan(scan_)->state))));
    EXPECT_THAT(rest.error().limit, HasSubstr("abort"));
  }
}

TEST_F(Completion, OfAScanThatLacksNothingIsRefused) {
  for (std::int32_t point = 0; point < 3; ++point) {
    accept(point, Target::Sample);
    accept(point, Target::Reference);
  }
  go(scan_, {ScanState::Preparing, ScanState::Running, ScanState::Finishing, ScanState::Done});

  EXPECT_THAT(complete(scan_).error().seen, HasSubstr("no point is missing"));
}

TEST_F(Completion, IsMadeOnceUnlessTheOneBeforeEndedWithNothing) {
  go(scan_, {ScanState::Aborted});
  const Result<NewScan> first = complete(scan_);
  ASSERT_TRUE(first);
  const ScanId completing = write({*first});

  const Result<NewScan> second = complete(scan_);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().seen, HasSubstr("scan " + std::to_string(completing) + " completes it"));
  go(completing, {ScanState::Aborted});
  const Result<NewScan> third = complete(scan_);
  ASSERT_TRUE(third);
  EXPECT_NE(third->idempotency_key, first->idempotency_key);
}

}  // namespace
}  // namespace gonio::daemon
