#include <gtest/gtest.h>

#include <memory>

#include "daemon/store/store_reader.h"
#include "daemon/store/store_writer.h"
#include "daemon/store/version_list.h"
#include "tests/daemon/support/scan_records.h"

namespace gonio::daemon {
namespace {

class FoundCalibrations : public testing::Test {
 protected:
  FoundCalibrations() {
    writer_ = std::move(StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_)).value();
    reader_ = std::move(StoreReader::open(path_)).value();
    scan_ = write(test::new_scan(test::bench_plan({30}, {10, 20}, {90})));
  }

  ScanId write(StoreWrite record) {
    const auto receipt = writer_->commit({.at = clock_.now(), .writes = {std::move(record)}, .events = {}});
    EXPECT_TRUE(receipt) << describe(receipt.error());
    return receipt ? receipt->new_scan : 0;
  }
  void find(const std::string& job, double value) {
    write(NewFoundCalibration{.scan = scan_,
                              .job = job,
                              .code_version = "jobs-1",
                              .inputs_json = "{}",
                              .found = {.values = {{"a", "deg", value}, {"b", "s", 2.0 * value}},
                                        .covariance = {4.0, 1.0, 1.0, 9.0},
                                        .note = "well"}});
  }
  std::vector<CalibrationVersion> counting() {
    std::vector<CalibrationVersion> versions;
    const auto all = reader_->found_calibrations();
    EXPECT_TRUE(all);
    for (const FoundCalibration& found : *all) {
      if (found.counts) versions.push_back(found.version);
    }
    return versions;
  }

  test::ScratchFolder folder_;
  std::string path_ = folder_.file("store.sqlite");
  ManualClock clock_;
  std::unique_ptr<StoreWriter> writer_;
  std::unique_ptr<StoreReader> reader_;
  ScanId scan_ = 0;
};

TEST_F(FoundCalibrations, ComeBackWithValuesCovarianceAndScan) {
  find("arm-zeros", 0.5);

  const auto all = reader_->found_calibrations();

  ASSERT_TRUE(all) << describe(all.error());
  ASSERT_EQ(all->size(), 1U);
  const FoundCalibration& one = all->front();
  EXPECT_EQ(one.version, 1);
  EXPECT_EQ(one.scan, scan_);
  EXPECT_EQ(one.job, "arm-zeros");
  EXPECT_FALSE(one.sample.empty());
  EXPECT_EQ(one.found.values[1], (calibration::FoundValue{"b", "s", 1.0}));
  EXPECT_EQ(one.found.u(1), 3.0);
  EXPECT_NEAR(one.found.correlation(0, 1), 1.0 / 6.0, 1e-15);
  EXPECT_EQ(one.found.note, "well");
  EXPECT_FALSE(one.counts) << "nobody has said so";
}

TEST_F(FoundCalibrations, CountFromTheirUseOnOneOfEachJob) {
  find("arm-zeros", 0.5);
  find("linearity", 0.1);
  find("arm-zeros", 0.6);

  write(UseCalibrationVersion{.version = 1, .who = "uid:7", .reason = "looked at"});
  write(UseCalibrationVersion{.version = 2, .who = "uid:7"});
  EXPECT_EQ(counting(), (std::vector<CalibrationVersion>{1, 2}));
  write(UseCalibrationVersion{.version = 3, .who = "uid:7"});
  EXPECT_EQ(counting(), (std::vector<CalibrationVersion>{2, 3}));
  write(UseCalibrationVersion{.version = 3, .in_use = false, .who = "uid:8", .reason = "the arm was taken apart"});
  EXPECT_EQ(counting(), (std::vector<CalibrationVersion>{2})) << "the one before does not come back by itself";

  const auto all = reader_->found_calibrations();
  ASSERT_EQ(all->at(2).uses.size(), 2U);
  EXPECT_EQ(all->at(2).uses[1].who, "uid:8");
  EXPECT_FALSE(all->at(2).uses[1].in_use);
  EXPECT_EQ(all->at(0).uses.size(), 1U) << "its history stays";
}

TEST_F(FoundCalibrations, OfNoVersionCannotBeUsed) {
  const auto receipt = writer_->commit(
      {.at = clock_.now(), .writes = {UseCalibrationVersion{.version = 9, .who = "uid:7"}}, .events = {}});

  EXPECT_FALSE(receipt);
}

TEST_F(FoundCalibrations, AreNamedByTheBrdfThatTheyMade) {
  find("arm-zeros", 0.5);
  const NewBrdf without{.scan = scan_, .code_version = "c", .inputs_json = "{}"};
  NewBrdf with = without;
  with.versions = {1};

  write(without);
  EXPECT_TRUE(reader_->brdf(scan_)->versions.empty());
  write(with);
  EXPECT_EQ(reader_->brdf(scan_)->versions, (std::vector<CalibrationVersion>{1}));
  EXPECT_EQ(reader_->brdf(scan_)->calibration, 2) << "the first one stays beside it";
}

TEST(VersionList, GoesThereAndBack) {
  EXPECT_EQ(version_list_text({3, 15}), "3 15");
  EXPECT_EQ(version_list_from("3 15"), (std::vector<CalibrationVersion>{3, 15}));
  EXPECT_TRUE(version_list_from("").empty());
}

}  // namespace
}  // namespace gonio::daemon
