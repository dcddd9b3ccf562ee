#include "protocol/stage/drive_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "protocol/stage/drive_stage_map.h"
#include "protocol/stage/io_map.h"

namespace gonio::stage {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

template <class Map, class Read>
Result<Map> parsed(const std::string& text, std::initializer_list<std::string_view> path, Read read) {
  Result<TomlReader> root = TomlReader::parse(text, "instrument.toml");
  if (!root) return failure(root.error());
  TomlReader table = *root;
  for (const std::string_view key : path) table = table.table(key);
  const Map map = read(table);
  if (auto done = root->finish(); !done) return failure(done.error());
  return map;
}

Result<DriveMap> drive_of(const std::string& text) {
  return parsed<DriveMap>(text, {"stage", "drives", "maps", "lexium32"}, read_drive_map);
}

std::string shipped() {
  return text_of(GONIO_DRIVES "/lexium32.toml");
}

std::string with(std::string text, const std::string& old, const std::string& now) {
  const auto at = text.find(old);
  EXPECT_NE(at, std::string::npos) << old;
  return text.replace(at, old.size(), now);
}

DriveStageMap six_drives() {
  DriveStageMap map;
  map.maps.emplace("lexium32", lexium32_drive_map());
  std::uint8_t unit = 1;
  for (const Axis a : kAllAxes) {
    map.axes[index_of(a)] = {.unit_id = unit++,
                             .map = "lexium32",
                             .scale = -1e-4,
                             .speed_scale = 0.25,
                             .acceleration_scale = 0.5,
                             .fixed = std::nullopt};
  }
  map.axes[index_of(Axis::PhiI)] = {.map = "", .fixed = 0.0};
  map.io = coupler_io_map(20);
  return map;
}

TEST(DriveMap, OfTheShippedFileIsTheOneThatTheSimulatorServes) {
  const auto map = drive_of(shipped());

  ASSERT_TRUE(map) << explain(map.error());
  EXPECT_EQ(*map, lexium32_drive_map());
}

TEST(DriveMap, ReadsBackWhatItWrites) {
  DriveMap map = lexium32_drive_map();
  map.reads = ReadFunction::Input;
  map.writes = WriteFunction::Single;
  map.looks = 7;
  map.registers["status"].low_word_first = true;
  map.commands[static_cast<std::size_t>(DriveVerb::Halt)].front() = {.reg = "control", .value = 0x4, .mask = 0x6};

  const auto read = drive_of(to_toml(map, "stage.drives.maps.lexium32"));

  ASSERT_TRUE(read) << explain(read.error());
  EXPECT_EQ(*read, map);
}

TEST(DriveMap, RefusesARegisterThatItDoesNotHaveAndSaysWhereAndWhichThereAre) {
  const std::string text = with(shipped(), "halt = [{write = \"control\"", "halt = [{write = \"contrl\"");
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find("contrl")), '\n');

  const auto map = drive_of(text);

  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, ErrorCode::InvalidInput);
  EXPECT_NE(explain(map.error()).find("contrl"), std::string::npos);
  EXPECT_NE(map.error().limit.find("control"), std::string::npos);
  ASSERT_TRUE(map.error().where);
  EXPECT_EQ(map.error().where->line, line);
}

TEST(DriveMap, RefusesADriveThatIsNotToldHowToHalt) {
  const auto map = drive_of(with(shipped(), "halt = [{write = \"control\", value = 0x02}]", ""));

  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, ErrorCode::MissingKey);
  EXPECT_NE(explain(map.error()).find("halt"), std::string::npos);
}

TEST(DriveMap, RefusesAConditionThatCanNeverHold) {
  const auto map = drive_of(with(shipped(), "mask = 0x6F, value = 0x07", "mask = 0x6F, value = 0x10"));

  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, ErrorCode::InvalidInput);
  EXPECT_NE(map.error().limit.find("0x6f"), std::string::npos);
}

TEST(DriveMap, RefusesAStepWithAnUnknownKeyOrValue) {
  const auto key = drive_of(with(shipped(), "unless_set = true}", "unles_set = true}"));
  const auto value = drive_of(with(shipped(), "value = \"speed\"}]", "value = \"sped\"}]"));

  ASSERT_FALSE(key);
  EXPECT_EQ(key.error().code, ErrorCode::UnknownKey);
  ASSERT_FALSE(value);
  EXPECT_EQ(value.error().code, ErrorCode::InvalidInput);
}

TEST(DriveMap, RefusesABootCheckThatSetupDoesNotWrite) {
  const auto map = drive_of(with(shipped(), "boot_check = \"speed\"", "boot_check = \"mode\""));

  ASSERT_FALSE(map);
  EXPECT_NE(explain(map.error()).find("setup"), std::string::npos);
}

TEST(DriveMap, NeedsAPosition) {
  const auto map = drive_of(with(shipped(), "position      =", "place      ="));

  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, ErrorCode::MissingKey);
}

TEST(IoMap, OfTheShippedFileIsTheOneThatTheSimulatorServes) {
  const auto map = parsed<IoMap>(text_of(GONIO_DRIVES "/coupler.toml"), {"stage", "drives", "io"}, read_io_map);

  ASSERT_TRUE(map) << explain(map.error());
  EXPECT_EQ(*map, coupler_io_map(20));
}

TEST(IoMap, MayBeNothingButAUnit) {
  const auto map = parsed<IoMap>("[io]\nunit_id = 3\n", {"io"}, read_io_map);

  ASSERT_TRUE(map) << explain(map.error());
  EXPECT_EQ(*map, IoMap{.unit_id = 3});
}

TEST(DriveStageMap, ReadsBackWhatItWrites) {
  const auto read =
      parsed<DriveStageMap>(to_toml(six_drives(), "stage.drives"), {"stage", "drives"}, read_drive_stage_map);

  ASSERT_TRUE(read) << explain(read.error());
  EXPECT_EQ(*read, six_drives());
}

TEST(DriveStageMap, RefusesTwoAxesOnOneUnitAndACouplerOnAnAxis) {
  DriveStageMap twice = six_drives();
  twice.axes[1].unit_id = 1;
  DriveStageMap coupler = six_drives();
  coupler.io->unit_id = 2;

  for (const DriveStageMap& map : {twice, coupler}) {
    const auto read = parsed<DriveStageMap>(to_toml(map, "stage.drives"), {"stage", "drives"}, read_drive_stage_map);
    ASSERT_FALSE(read);
    EXPECT_NE(explain(read.error()).find("already belongs to"), std::string::npos) << explain(read.error());
  }
}

TEST(DriveStageMap, RefusesAMapThatIsNotThere) {
  DriveStageMap map = six_drives();
  map.axes[2].map = "lexium";

  const auto read = parsed<DriveStageMap>(to_toml(map, "stage.drives"), {"stage", "drives"}, read_drive_stage_map);

  ASSERT_FALSE(read);
  EXPECT_NE(explain(read.error()).find("stage.drives.maps"), std::string::npos);
}

}  // namespace
}  // namespace gonio::stage
