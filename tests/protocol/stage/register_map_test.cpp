#include "protocol/stage/register_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace gonio::stage {
namespace {

using testing::HasSubstr;

struct Read {
  RegisterMap map;
  Result<void> outcome;
};

Read read(const std::string& text) {
  auto root = TomlReader::parse(text, "instrument.toml");
  if (!root) return {{}, failure(root.error())};
  TomlReader stage = root->table("stage");
  TomlReader registers = stage.table("registers");
  Read result{read_register_map(registers), {}};
  result.outcome = root->finish();
  return result;
}

std::string own_text() {
  return to_toml(own_register_map(), "stage.registers");
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

TEST(OwnRegisterMap, StartsWithTheTokenAndItsIdentity) {
  const RegisterMap map = own_register_map();

  EXPECT_EQ(map.at(Field::Token), (Register{0, 1, false, false}));
  EXPECT_EQ(map.at(Field::Identity), (Register{1, 1, false, false}));
  EXPECT_EQ(map.at(Field::MapVersion), (Register{2, 1, false, false}));
  EXPECT_EQ(map.at(Field::BootCounter), (Register{3, 2, false, false}));
  EXPECT_EQ(map.at(Field::Status), (Register{5, 1, false, false}));
}

TEST(OwnRegisterMap, IsReadInOneTransaction) {
  const Block block = own_register_map().status_block();

  EXPECT_EQ(block.first, 0);
  EXPECT_EQ(block.count, 80);  // 32 of the stage, 6 axes of 8
}

TEST(OwnRegisterMap, WritesAMotionInOneTransactionThatEndsWithTheCommand) {
  const RegisterMap map = own_register_map();
  const Block block = map.motion_block();

  EXPECT_EQ(block.count, 2 + 1 + 1 + 6 * 2 + 1);  // epoch, token, mask, targets, command
  EXPECT_EQ(map.at(Field::MotionCommand).address, block.first + block.count - 1);
}

TEST(OwnRegisterMap, HoldsSignedPositionsAndTemperatures) {
  const RegisterMap map = own_register_map();

  EXPECT_TRUE(map.at(Axis::ThetaI, AxisField::Encoder).is_signed);
  EXPECT_TRUE(map.at(Axis::ThetaI, AxisField::Target).is_signed);
  EXPECT_TRUE(map.at(Field::RoomTemperature).is_signed);
  EXPECT_FALSE(map.at(Field::Epoch).is_signed);
}

TEST(RegisterMap, ComesBackEqualFromItsOwnText) {
  const Read back = read(own_text());

  ASSERT_TRUE(back.outcome.has_value()) << describe(back.outcome.error());
  EXPECT_EQ(back.map, own_register_map());
}

TEST(RegisterMap, KeepsWordOrderAndNegativeScaleThroughItsText) {
  RegisterMap map = own_register_map();
  map.fields[static_cast<std::size_t>(Field::Epoch)].low_word_first = true;
  map.axis_scale[index_of(Axis::PhiR)] = -2.5e-5;
  map.unit_id = 17;

  const Read back = read(to_toml(map, "stage.registers"));

  ASSERT_TRUE(back.outcome.has_value()) << describe(back.outcome.error());
  EXPECT_EQ(back.map, map);
}

TEST(RegisterMap, RefusesAMissingRegisterByName) {
  const Read back = read(replaced(own_text(), "stop_count = {address = 9, words = 1}\n", ""));

  ASSERT_FALSE(back.outcome.has_value());
  EXPECT_EQ(back.outcome.error().code, ErrorCode::MissingKey);
  EXPECT_THAT(back.outcome.error().where->field, HasSubstr("stop_count"));
}

TEST(RegisterMap, RefusesAnUnknownRegister) {
  const Read back = read(replaced(own_text(), "stop_count = ", "stop_counts = {address = 900}\nstop_count = "));

  ASSERT_FALSE(back.outcome.has_value());
  EXPECT_EQ(back.outcome.error().code, ErrorCode::UnknownKey);
}

TEST(RegisterMap, RefusesTwoValuesOnOneRegister) {
  const Read back = read(replaced(own_text(), "fault = {address = 6,", "fault = {address = 5,"));

  ASSERT_FALSE(back.outcome.has_value());
  EXPECT_EQ(back.outcome.error().code, ErrorCode::InvalidInput);
  EXPECT_THAT(back.outcome.error().seen, HasSubstr("register 5 already belongs to status"));
}

TEST(RegisterMap, RefusesAStatusBlockThatOneReadCannotHold) {
  const Read back = read(replaced(own_text(), "humidity = {address = 22,", "humidity = {address = 125,"));

  ASSERT_FALSE(back.outcome.has_value());
  EXPECT_THAT(back.outcome.error().seen, HasSubstr("126 registers"));
  EXPECT_THAT(back.outcome.error().limit, HasSubstr("125"));
}

TEST(RegisterMap, RefusesACommandWithAGap) {
  const Read back = read(replaced(own_text(), "halt_key = {address = 162,", "halt_key = {address = 164,"));

  ASSERT_FALSE(back.outcome.has_value());
  EXPECT_THAT(back.outcome.error().where->field, HasSubstr("halt_key"));
}

TEST(RegisterMap, RefusesAMotionWhoseCommandIsNotWrittenLast) {
  const std::string swapped =
      replaced(replaced(own_text(), "motion_command = {address = 144,", "motion_command = {address = 131,"),
               "motion_mask = {address = 131,", "motion_mask = {address = 144,");

  const Read back = read(swapped);

  ASSERT_FALSE(back.outcome.has_value());
  EXPECT_THAT(back.outcome.error().seen, HasSubstr("not the last"));
}

TEST(RegisterMap, RefusesAScaleOfZero) {
  const Read back = read(replaced(own_text(), "monitor_scale = 1e-07", "monitor_scale = 0"));

  ASSERT_FALSE(back.outcome.has_value());
  EXPECT_THAT(back.outcome.error().where->field, HasSubstr("monitor_scale"));
}

TEST(RegisterMap, RefusesAnAddressPastTheEndOfTheAddressSpace) {
  const Read back = read(replaced(own_text(), "heartbeat = {address = 208,", "heartbeat = {address = 65536,"));

  ASSERT_FALSE(back.outcome.has_value());
  EXPECT_EQ(back.outcome.error().code, ErrorCode::InvalidInput);
}

TEST(RegisterMap, GivesEachFieldItsOwnName) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < kFieldCount; ++i) names.insert(field_name(static_cast<Field>(i)));

  EXPECT_EQ(names.size(), kFieldCount);
  EXPECT_EQ(field_name(Field::MotionCommand), "motion_command");
  EXPECT_EQ(field_name(Field::GateMonitorSe), "gate_monitor_se");
  EXPECT_EQ(field_name(AxisField::GateCloseEncoder), "gate_close_encoder");
  EXPECT_EQ(refusal_name(Refusal::BadCommand), "bad command");
}

}  // namespace
}  // namespace gonio::stage
