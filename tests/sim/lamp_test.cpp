#include "sim/optics/lamp.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

// The sample covers many cells or seeds; statistics of a seeded run are held to five standard errors.
TEST(Lamp, HasTheFlickerOfItsCellsAveraged) {
  Scene scene = quiet_scene();
  scene.lamp.flicker = 0.01;
  scene.lamp.flicker_cell_s = 0.01;
  SCOPED_TRACE(scene.seed);
  const Lamp lamp(scene);
  constexpr int kCells = 4000;

  double sum2_one = 0.0;
  double sum2_nine = 0.0;
  for (int k = 0; k < kCells; ++k) {
    sum2_one += std::pow(lamp.mean(0.01 * k, 0.01 * k + 0.01) - 1.0, 2);
    sum2_nine += std::pow(lamp.mean(0.09 * k, 0.09 * k + 0.09) - 1.0, 2);
  }

  EXPECT_NEAR(std::sqrt(sum2_one / kCells), 0.01, 0.01 * 5.0 / std::sqrt(2.0 * kCells));
  EXPECT_NEAR(std::sqrt(sum2_nine / kCells), 0.01 / 3.0, 0.01 / 3.0 * 5.0 / std::sqrt(2.0 * kCells));
}

TEST(Lamp, HasAMeanThatTheMeansOfItsPartsAverageTo) {
  Scene scene = quiet_scene();
  scene.lamp.flicker = 0.01;
  const Lamp lamp(scene);

  const double whole = lamp.mean(1.003, 1.097);
  const double parts = (lamp.mean(1.003, 1.0431) * 0.0401 + lamp.mean(1.0431, 1.097) * 0.0539) / 0.094;

  EXPECT_NEAR(whole, parts, 1e-12);
}

TEST(Lamp, ShowsItsMonitorTheSameLightAndNoMore) {
  Scene scene = quiet_scene();
  scene.lamp.flicker = 0.01;
  scene.lamp.drift_per_hour = 0.1;
  const Lamp lamp(scene);

  const MonitorReading reading = lamp.monitor(10.0, 10.02, 1);

  EXPECT_EQ(reading.mean, lamp.mean(10.0, 10.02));
  EXPECT_EQ(reading.standard_error, 0.0);
}

TEST(Lamp, StatesAStandardErrorThatItsMonitorReallyHas) {
  Scene scene = quiet_scene();
  scene.lamp.monitor_noise = 0.01;
  scene.lamp.monitor_rate_hz = 1000.0;
  SCOPED_TRACE(scene.seed);
  const Lamp lamp(scene);
  constexpr int kReadings = 4000;

  double error2 = 0.0;
  double claimed2 = 0.0;
  for (int k = 1; k <= kReadings; ++k) {
    const MonitorReading reading = lamp.monitor(0.0, 0.02, static_cast<std::uint64_t>(k));
    EXPECT_EQ(reading.samples, 20U);
    error2 += std::pow(reading.mean - 1.0, 2) / kReadings;
    claimed2 += std::pow(reading.standard_error, 2) / kReadings;
  }

  EXPECT_NEAR(std::sqrt(error2), 0.01 / std::sqrt(20.0), 5.0 * 0.01 / std::sqrt(40.0 * kReadings));
  EXPECT_NEAR(std::sqrt(claimed2), 0.01 / std::sqrt(20.0), 5.0 * 0.01 / std::sqrt(40.0 * kReadings));
}

TEST(Lamp, DriftsFromItsMonitorByWhatIsStatedBetweenReadingsFarApart) {
  constexpr int kSeeds = 2000;
  double far2 = 0.0;
  double near2 = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Scene scene = quiet_scene();
    scene.seed = seed;
    scene.lamp.u_after_monitor = 0.001;
    scene.lamp.correlation_s = 100.0;
    const Lamp lamp(scene);
    const auto ratio = [&](double at) { return lamp.monitor(at, at + 0.01, 1).mean; };
    far2 += std::pow(ratio(1000.0) - ratio(0.0), 2) / kSeeds;
    near2 += std::pow(ratio(10.0) - ratio(0.0), 2) / kSeeds;
  }

  EXPECT_NEAR(std::sqrt(far2), 0.001, 0.001 * 5.0 / std::sqrt(2.0 * kSeeds));
  // rms = u sqrt(1 - exp(-dt^2 / 2 tau^2)) = 0.0706 u at a tenth of the correlation time.
  EXPECT_NEAR(std::sqrt(near2), 0.0000706, 0.0000706 * 5.0 / std::sqrt(2.0 * kSeeds));
}

}  // namespace
}  // namespace gonio::sim::test
