#include "daemon/tape/tape_input.h"

#include <gtest/gtest.h>

#include "tests/daemon/support/bench_instrument.h"

namespace gonio::daemon {
namespace {

SequencerMessage there_and_back(Verb verb) {
  const auto taped = tape_input_of(Command{.id = 7, .who = "uid:1000", .verb = std::move(verb)});
  EXPECT_TRUE(taped);
  const auto message = message_of(*taped, test::bench_instrument());
  EXPECT_TRUE(message) << describe(message.error());
  return message ? *message : SequencerMessage{};
}

TEST(TapeInput, KeepsAReadingByHandToTheNanosecond) {
  const auto message = there_and_back(
      ReadDetector{.exposure = std::chrono::nanoseconds(12'345'679), .range_w = std::nullopt, .lit = false});

  const auto& command = std::get<Command>(message);
  const auto& read = std::get<ReadDetector>(command.verb);
  EXPECT_EQ(command.id, 7U);
  EXPECT_EQ(read.exposure, std::chrono::nanoseconds(12'345'679));
  EXPECT_FALSE(read.range_w);
  EXPECT_EQ(read.lit, false);
}

TEST(TapeInput, KeepsARangeAndLeavesOpenWhatWasLeftOpen) {
  const auto message = there_and_back(ReadDetector{.range_w = 1e-3});

  const auto& read = std::get<ReadDetector>(std::get<Command>(message).verb);
  EXPECT_FALSE(read.exposure);
  EXPECT_EQ(read.range_w, 1e-3);
  EXPECT_FALSE(read.lit);
}

TEST(TapeInput, KeepsWhatCountsAsCalibrationAndWhatIsComputedAnew) {
  const auto use = std::get<UseCalibration>(
      std::get<Command>(there_and_back(UseCalibration{.version = 5, .in_use = false, .reason = "bent"})).verb);
  const auto with = std::get<RecomputeScan>(
      std::get<Command>(there_and_back(RecomputeScan{.scan = 3, .versions = {{5, 7}}})).verb);
  const auto open = std::get<RecomputeScan>(std::get<Command>(there_and_back(RecomputeScan{.scan = 3})).verb);

  EXPECT_EQ(use.version, 5);
  EXPECT_FALSE(use.in_use);
  EXPECT_EQ(use.reason, "bent");
  EXPECT_EQ(with.scan, 3);
  EXPECT_EQ(with.versions, (std::vector<CalibrationVersion>{5, 7}));
  EXPECT_FALSE(open.versions);
}

}  // namespace
}  // namespace gonio::daemon
