// The simulator's own forward geometry, by quaternions, beside the test's matrices and the driver's.
#include <gtest/gtest.h>

#include <random>

#include "drivers/kinematics/turning_sample.h"
#include "sim/optics/turning_geometry.h"
#include "tests/drivers/kinematics/forward_geometry.h"

namespace gonio::drivers {
namespace {

TEST(SimulatedTurningSample, HasTheDirectionsOfMatricesAndOfTheDriver) {
  constexpr unsigned kSeed = 7;
  SCOPED_TRACE(kSeed);
  std::mt19937_64 chance(kSeed);
  std::uniform_real_distribution<double> turn(-3.0, 3.0);
  for (int k = 0; k < 5000; ++k) {
    const TurningSample told{.source_azimuth = radians(turn(chance)),
                             .source_elevation = radians(0.3 * turn(chance)),
                             .detector_plane_tilt = radians(turn(chance))};
    const sim::TurningSampleSpec spec{.source_azimuth = told.source_azimuth,
                                      .source_elevation = told.source_elevation,
                                      .detector_plane_tilt = told.detector_plane_tilt};
    const SampleTurns turns{radians(turn(chance)), radians(turn(chance)), radians(turn(chance)), radians(turn(chance))};
    const auto simulated =
        test::directions_of_geometry(sim::directions_on(spec, {turns.yaw, turns.pitch, turns.roll, turns.detector}));
    const auto matrices = test::forward(told, turns);
    const auto driver = test::directions_of_geometry(directions_of(told, turns));
    EXPECT_LT(test::arc(simulated.source, matrices.source), 2e-15);
    EXPECT_LT(test::arc(simulated.detector, matrices.detector), 2e-15);
    EXPECT_LT(test::arc(simulated.source, driver.source), 2e-15);
    EXPECT_LT(test::arc(simulated.detector, driver.detector), 2e-15);
  }
}

}  // namespace
}  // namespace gonio::drivers
