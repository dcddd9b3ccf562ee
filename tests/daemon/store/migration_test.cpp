// Files that earlier versions wrote: opened, brought forward, and their scans gone on with.
#include <SQLiteCpp/SQLiteCpp.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "daemon/store/schema.h"
#include "daemon/store/store_reader.h"
#include "daemon/store/store_writer.h"
#include "tests/daemon/support/scan_records.h"

namespace gonio::daemon {
namespace {

class OldStore : public testing::Test {
 protected:
  void write(const std::string& name) {
    std::ifstream in(std::string(GONIO_OLD_STORES "/") + name);
    const std::string sql((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    ASSERT_FALSE(sql.empty()) << name;
    SQLite::Database file(path_, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    file.exec(sql);
  }

  test::ScratchFolder folder_;
  std::string path_ = folder_.file("old.sqlite");
  ManualClock clock_;
};

TEST_F(OldStore, OfVersion1IsRefusedToReadersUntilAWriterHasBroughtItForward) {
  write("version_1.sql");

  EXPECT_EQ(StoreReader::open(path_).error().code, ErrorCode::StoreFailed);
  const auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
  ASSERT_TRUE(writer) << describe(writer.error());
  EXPECT_TRUE(StoreReader::open(path_));
  SQLite::Database file(path_, SQLite::OPEN_READONLY);
  EXPECT_EQ(file.execAndGet("PRAGMA user_version").getInt(), kSchemaVersion);
}

TEST_F(OldStore, OfVersion1KeepsItsScanWhichChoosesItsExposures) {
  write("version_1.sql");
  const auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
  ASSERT_TRUE(writer) << describe(writer.error());

  const auto reader = StoreReader::open(path_);
  ASSERT_TRUE(reader) << describe(reader.error());
  const auto info = (*reader)->scan(1);
  const auto points = (*reader)->points(1, -1, 10);

  ASSERT_TRUE(info && points);
  EXPECT_EQ(info->name, "old scan");
  EXPECT_EQ(info->policy.target_snr, 250.0);
  EXPECT_TRUE(info->policy.exposures.empty());
  EXPECT_EQ(info->policy.dark_every, std::chrono::seconds(300));
  EXPECT_EQ(points->size(), 2U);
}

TEST_F(OldStore, OfVersion1HasScansThatReadTheStandardAtEveryGeometry) {
  write("version_1.sql");
  const auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
  ASSERT_TRUE(writer) << describe(writer.error());

  const auto reader = StoreReader::open(path_);
  ASSERT_TRUE(reader) << describe(reader.error());
  const auto info = (*reader)->scan(1);

  ASSERT_TRUE(info) << describe(info.error());
  EXPECT_EQ(info->policy.reference_mode, api::ReferenceMode::SameGeometry);
  EXPECT_NEAR(in_degrees(info->policy.anchor.theta_r), 45.0, 1e-12);
}

TEST_F(OldStore, OfVersion1GainsReductionsAndTemperaturesThatMayBeUnknown) {
  write("version_1.sql");
  const auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
  ASSERT_TRUE(writer) << describe(writer.error());

  SQLite::Database file(path_, SQLite::OPEN_READONLY);

  EXPECT_EQ(file.execAndGet("SELECT count(*) FROM frame_reduction").getInt(), 0);
  EXPECT_EQ(file.execAndGet("SELECT count(*) FROM reading WHERE (camera_temperature_c = 0) = camera_temperature_known")
                .getInt(),
            0);
}

TEST_F(OldStore, OfVersion1GetsATableForRadiometersAndKeepsItsReadings) {
  write("version_1.sql");
  const auto readings = [this] {
    SQLite::Database file(path_, SQLite::OPEN_READONLY);
    return file.execAndGet("SELECT count(*) FROM reading").getInt();
  };
  const int before = readings();
  const auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
  ASSERT_TRUE(writer) << describe(writer.error());

  EXPECT_EQ(readings(), before);
  SQLite::Database file(path_, SQLite::OPEN_READONLY);
  EXPECT_EQ(file.execAndGet("SELECT count(*) FROM power_reading").getInt(), 0);
}

TEST_F(OldStore, OfVersion1HasScansOfOrdinaryTurn) {
  write("version_1.sql");
  const auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
  ASSERT_TRUE(writer) << describe(writer.error());

  const auto info = (*StoreReader::open(path_))->scan(1);

  ASSERT_TRUE(info) << describe(info.error());
  EXPECT_EQ(info->turn.priority, 0);
  EXPECT_FALSE(info->turn.preempts || info->turn.start);
  EXPECT_EQ(info->turn.completes, 0);
  EXPECT_EQ(info->completed_by, 0);
}

TEST_F(OldStore, OfVersion1KeepsItsDecisionsAsTheFirstRound) {
  write("version_1.sql");
  const auto items = [this](const std::string& what) {
    SQLite::Database file(path_, SQLite::OPEN_READONLY);
    return file
        .execAndGet("SELECT group_concat(point_index || target || outcome || coalesce(attempt_id, '')) FROM " + what)
        .getString();
  };
  SQLite::Database(path_, SQLite::OPEN_READWRITE)
      .exec("INSERT INTO item VALUES (1, 0, 'sample', 'skipped', NULL, 'uid:1', 'asked')");
  const std::string before = items("item");
  ASSERT_EQ(before, "0sampleskipped");
  const auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
  ASSERT_TRUE(writer) << describe(writer.error());

  EXPECT_EQ(items("decided_item WHERE round = 1"), before);
  const auto unfinished = (*writer)->unfinished();
  ASSERT_TRUE(unfinished) << describe(unfinished.error());
  ASSERT_EQ(unfinished->size(), 1U);
  EXPECT_EQ(unfinished->front().skipped, (std::vector<ItemKey>{{0, calibration::Target::Sample}}));
  EXPECT_EQ(unfinished->front().policy.reference_every, Duration{});
  EXPECT_TRUE(unfinished->front().reopened.empty());
}

TEST_F(OldStore, OfVersion1ShowsIdleTimeThatNobodyToldApartAsTheDaemonsOwn) {
  write("version_1.sql");
  SQLite::Database(path_, SQLite::OPEN_READWRITE)
      .exec("INSERT INTO visit VALUES (NULL, 1, 'dark', 0, 1, 2, 3, 4, 5000, (SELECT max(run_id) FROM run), 6, 7, 8)");
  const auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
  ASSERT_TRUE(writer) << describe(writer.error());

  const auto info = StoreReader::open(path_).value()->scan(1);

  ASSERT_TRUE(info);
  EXPECT_EQ(info->spent.idle.planning, Duration(5000));
  EXPECT_EQ(info->spent.idle.wire, Duration::zero());
}

TEST_F(OldStore, OfVersion1HasPlansWithoutFilesAndPointsThatAreMeasuredOnce) {
  write("version_1.sql");
  const auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
  ASSERT_TRUE(writer) << describe(writer.error());

  const auto reader = StoreReader::open(path_);
  ASSERT_TRUE(reader) << describe(reader.error());
  const auto texts = (*reader)->texts(1);
  const auto points = (*reader)->points(1, -1, 10);

  ASSERT_TRUE(texts && points);
  EXPECT_TRUE(texts->plan_parts.empty());
  ASSERT_EQ(points->size(), 2U);
  EXPECT_EQ(points->back().point.repeat, 1);
}

TEST_F(OldStore, OfVersion1KeepsItsBrdfWithIntervalsOfItsOwnTermsAndTheSignsThatItsNamesTold) {
  write("version_1.sql");
  SQLite::Database(path_, SQLite::OPEN_READWRITE)
      .exec(
          "INSERT INTO calibration VALUES (7, 1, 'old', '{}', "
          "'[\"certificate\",\"zero theta_i through unresolved slopes\",\"dark drift 1 to 5\"]', 8);"
          "INSERT INTO brdf VALUES (7, 1, 0, 0.3, 0.001, 0.0, 0, 0.0, 0.0, 30.0, 0.0, x'')");
  const auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
  ASSERT_TRUE(writer) << describe(writer.error());

  const auto brdf = (*StoreReader::open(path_))->brdf(1);

  ASSERT_TRUE(brdf) << describe(brdf.error());
  EXPECT_EQ(brdf->sizes_only, (std::vector<std::uint32_t>{1, 2}));
  ASSERT_EQ(brdf->rows.size(), 1U);
  EXPECT_FALSE(brdf->rows[0].interval.has_value());
}

TEST_F(OldStore, OfVersion1HasNoSumsOfFrames) {
  write("version_1.sql");
  const auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
  ASSERT_TRUE(writer) << describe(writer.error());
  const auto reader = StoreReader::open(path_);
  ASSERT_TRUE(reader) << describe(reader.error());

  const auto stacks = (*reader)->pixel_stacks(1);

  ASSERT_TRUE(stacks) << describe(stacks.error());
  EXPECT_TRUE(stacks->dark.empty() && stacks->lit.empty());
  EXPECT_EQ((*reader)->scan(1)->policy.map_frames, 0);
}

TEST_F(OldStore, OfVersion1HasFoundNothingByCalibrationJobs) {
  write("version_1.sql");
  const auto writer = StoreWriter::open({.path = path_, .boot_id = "boot-a", .version = "test"}, clock_);
  ASSERT_TRUE(writer) << describe(writer.error());

  const auto found = (*StoreReader::open(path_))->found_calibrations();

  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_TRUE(found->empty());
}

}  // namespace
}  // namespace gonio::daemon
