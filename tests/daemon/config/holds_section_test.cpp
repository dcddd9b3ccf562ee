#include "daemon/config/holds_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gonio::daemon {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kMiB = 1024 * 1024;

Result<HoldRules> holds(const std::string& text) {
  Result<TomlReader> root = TomlReader::parse(text, "instrument.toml");
  if (!root) return failure(root.error());
  const HoldRules rules = read_holds(*root);
  GONIO_TRY(root->finish());
  return rules;
}

Result<std::optional<LampWarmUp>> warm_up(const std::string& text) {
  Result<TomlReader> root = TomlReader::parse(text, "instrument.toml");
  if (!root) return failure(root.error());
  TomlReader lamp = root->table("lamp");
  const auto warm = read_warm_up(lamp);
  GONIO_TRY(root->finish());
  return warm;
}

TEST(HoldsSection, WithoutItNoHoldEndsByItselfAndTheDiskHasItsLimits) {
  const auto rules = holds("");

  ASSERT_TRUE(rules) << describe(rules.error());
  EXPECT_FALSE(rules->lamp || rules->door || rules->device || rules->disk);
  EXPECT_EQ(rules->disk_least_bytes, 100 * kMiB);
  EXPECT_EQ(rules->disk_again_bytes, 125 * kMiB);
}

TEST(HoldsSection, EachTimeIsItsOwn) {
  const auto rules = holds("[holds]\nlamp_s = 60\ndoor_s = 0.5\ndevice_s = 7\ndisk_s = 0\n");

  ASSERT_TRUE(rules) << describe(rules.error());
  EXPECT_EQ(rules->lamp, std::chrono::seconds(60));
  EXPECT_EQ(rules->door, std::chrono::milliseconds(500));
  EXPECT_EQ(rules->device, std::chrono::seconds(7));
  EXPECT_EQ(rules->disk, Duration::zero()) << "at once is a time too";
}

TEST(HoldsSection, RoomComesBackAQuarterAboveTheLimitUnlessTheFileSaysMore) {
  const auto by_least = holds("[holds]\ndisk_least_mib = 200\n");
  const auto by_both = holds("[holds]\ndisk_least_mib = 200\ndisk_again_mib = 300\n");

  ASSERT_TRUE(by_least && by_both);
  EXPECT_EQ(by_least->disk_again_bytes, 250 * kMiB);
  EXPECT_EQ(by_both->disk_least_bytes, 200 * kMiB);
  EXPECT_EQ(by_both->disk_again_bytes, 300 * kMiB);
}

TEST(HoldsSection, RoomThatComesBackBelowTheLimitIsRefused) {
  const auto rules = holds("[holds]\ndisk_least_mib = 200\ndisk_again_mib = 150\n");

  ASSERT_FALSE(rules);
  ASSERT_TRUE(rules.error().where);
  EXPECT_EQ(rules.error().where->field, "holds.disk_again_mib");
  EXPECT_EQ(rules.error().where->line, 3);
}

TEST(HoldsSection, ANegativeTimeAndAMisspeltKeyAreRefusedWithTheirNames) {
  const auto negative = holds("[holds]\ndoor_s = -1\n");
  const auto misspelt = holds("[holds]\ndoors_s = 10\n");

  ASSERT_FALSE(negative);
  EXPECT_EQ(negative.error().where->field, "holds.door_s");
  ASSERT_FALSE(misspelt);
  EXPECT_EQ(misspelt.error().code, ErrorCode::UnknownKey);
  EXPECT_THAT(describe(misspelt.error()), HasSubstr("door_s"));
}

TEST(WarmUpSection, IsNotThereUnlessItIsNamed) {
  const auto warm = warm_up("[lamp]\n");

  ASSERT_TRUE(warm) << describe(warm.error());
  EXPECT_FALSE(*warm);
}

TEST(WarmUpSection, GivesItsSlopeAsAPartASecond) {
  const auto warm = warm_up("[lamp]\nwarm_up = {slope_percent_per_min = 0.06, over_s = 300, at_most_s = 3600}\n");

  ASSERT_TRUE(warm && *warm);
  EXPECT_DOUBLE_EQ((*warm)->slope_per_s, 1e-5);  // 0.06 % a minute by hand
  EXPECT_EQ((*warm)->over, std::chrono::minutes(5));
  EXPECT_EQ((*warm)->at_most, std::chrono::hours(1));
}

TEST(WarmUpSection, CannotGiveUpBeforeItHasLookedForLongEnough) {
  const auto warm = warm_up("[lamp]\nwarm_up = {slope_percent_per_min = 0.06, over_s = 300, at_most_s = 299}\n");

  ASSERT_FALSE(warm);
  EXPECT_EQ(warm.error().where->field, "lamp.warm_up.at_most_s");
}

TEST(WarmUpSection, NeedsEachOfItsNumbers) {
  for (const char* text : {"{over_s = 300, at_most_s = 3600}", "{slope_percent_per_min = 0.06, at_most_s = 3600}",
                           "{slope_percent_per_min = 0.06, over_s = 300}"}) {
    const auto warm = warm_up(std::string("[lamp]\nwarm_up = ") + text + "\n");
    ASSERT_FALSE(warm) << text;
    EXPECT_EQ(warm.error().code, ErrorCode::MissingKey) << text;
  }
}

}  // namespace
}  // namespace gonio::daemon
