#include "sim/goniosim/exposure_journal.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "sim/goniosim/state_folder.h"
#include "tests/sim/bench.h"
#include "tests/support/process.h"

namespace gonio::sim::test {
namespace {

using gonio::test::TemporaryFolder;

void keep_count(Bench& bench, const ExposureJournal& journal) {
  bench.instrument.tell_exposures_to([&journal](const ExposureNote& exposure) { journal.note(exposure); });
}

TEST(ExposureJournal, GivesASimulatorThatWasKilledWhatItExposedSinceItsLastSave) {
  const TemporaryFolder folder;
  const StateFolder state = *StateFolder::open(folder.path());
  const ExposureJournal journal = *ExposureJournal::open(state.exposure_journal());
  Bench bench;
  keep_count(bench, journal);
  bench.home();
  bench.open_shutters();
  bench.wait(20.0);
  (void)bench.expose(0.01);
  ASSERT_TRUE(state.save({.instrument = bench.instrument.memory(bench.now), .camera_address = {}}));

  bench.move(Axis::ThetaI, 30.0);
  bench.wait(20.0);
  (void)bench.expose(0.01);
  (void)bench.expose(0.01);
  const InstrumentMemory killed = bench.instrument.memory(bench.now);

  const InstrumentMemory found = state.load()->instrument;
  EXPECT_EQ(found.exposures, 3U);
  EXPECT_EQ(found.lit_exposures, 3U);
  EXPECT_EQ(found.places, killed.places);
  EXPECT_EQ(found.stage.moves, killed.stage.moves);
  EXPECT_EQ(found.stage.positions, killed.stage.positions);
  EXPECT_NEAR(found.scene_time_s, killed.scene_time_s, 0.1) << "that of the last exposure's beginning";
}

TEST(ExposureJournal, AddsNothingToAStateThatIsUpToDate) {
  const TemporaryFolder folder;
  const StateFolder state = *StateFolder::open(folder.path());
  const ExposureJournal journal = *ExposureJournal::open(state.exposure_journal());
  Bench bench;
  keep_count(bench, journal);
  for (int k = 0; k < 3; ++k) (void)bench.expose(0.01);

  ASSERT_TRUE(state.save({.instrument = bench.instrument.memory(bench.now), .camera_address = {}}));

  EXPECT_EQ(state.load()->instrument.exposures, 3U);
  EXPECT_EQ(state.load()->instrument.places, bench.instrument.memory(bench.now).places);
}

TEST(ExposureJournal, TakesNoHalfSlotForAnExposure) {
  const TemporaryFolder folder;
  const StateFolder state = *StateFolder::open(folder.path());
  const ExposureJournal journal = *ExposureJournal::open(state.exposure_journal());
  ASSERT_TRUE(state.save({}));
  Bench bench;
  keep_count(bench, journal);
  (void)bench.expose(0.01);
  const auto one = std::filesystem::file_size(state.exposure_journal());
  std::filesystem::resize_file(state.exposure_journal(), one - 4);

  EXPECT_EQ(state.load()->instrument.exposures, 0U);
}

}  // namespace
}  // namespace gonio::sim::test
