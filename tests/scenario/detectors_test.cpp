// One plan, one seed, four instruments that differ in their configuration only: they find the same BRDF.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iostream>
#include <string>
#include <string_view>

#include "tests/scenario/agreement.h"
#include "tests/scenario/bench.h"
#include "tests/scenario/programs.h"
#include "tests/scenario/store_copy.h"

namespace gonio::test {
namespace {

constexpr double kLeastP = 0.001;
constexpr double kMostP = 0.999;
constexpr std::uint64_t kSeed = 20261122;

// A lamp that goes up and down by 5 % within the scan, so that a monitor that is not believed shows. No flicker: how
// much of it two meters have in common depends on how busy the machine is.
constexpr const char* kLamp =
    "[source]\npower = 1.0\nwave = 0.05\nwave_period_s = 4000.0\nmonitor_noise = 0.002\nmonitor_rate_hz = 10000.0\n"
    "u_after_monitor = 0.0005\ncorrelation_s = 3600.0\nu_reproducibility = 0.005\n";

std::string meter(const std::string& role, const std::string& serial, double noise) {
  return "[[radiometers]]\nrole = \"" + role + "\"\nserial = \"" + serial +
         "\"\nranges_w = [1e-5, 1e-4, 1e-3, 1e-2]\naverage_s = 0.04\nsettle_s = 0.02\nzero_s = 1.0\noffset = 1e-3\n"
         "u_range = 0.0005\nnoise = " +
         std::to_string(noise) + "\n";
}

struct Configuration {
  std::string name;
  std::string wire;
  std::string radiometers;
};

const std::array<Configuration, 4> kConfigurations{
    {{"TCP and camera", "tcp", ""},
     {"RTU and camera", "rtu", ""},
     {"TCP, radiometer as detector, radiometer as monitor", "tcp",
      meter("detector", "SIM-PM-01", 1e-4) + meter("monitor", "SIM-PM-02", 2e-5)},
     {"TCP and camera, radiometer as monitor", "tcp", meter("monitor", "SIM-PM-02", 2e-5)}}};

// The seed draws these once for the bench: every instrument on it has the same error, which cancels in a difference.
// What is left: noise, placing and repeatability (random), and the components of each run's own darks, lamp stretches
// and shared reference readings. The camera's linearity is an error that the radiometer has not; a gain of a range one
// that the camera has not.
bool is_common_to_the_bench(std::string_view component) {
  constexpr std::array<std::string_view, 6> kCommon{"certificate",   "shape mode", "shape integral",
                                                    "shape between", "zero theta", "zero phi"};
  return std::ranges::any_of(kCommon, [&](std::string_view name) { return component.starts_with(name); });
}

// One block, and darks at both ends only: the order of the moves is the same on any machine. What scatters most is the
// placing, which the seed draws for each move: so p hardly depends on the machine either. (The noise of readings does:
// how many there are follows from times.)
std::map<long, StoredValue> measure(const Configuration& configuration, long number) {
  // Each run has moves and exposures of its own behind it: else all would draw the very same noise.
  Bench bench{SceneOptions{.time_scale = 20.0,
                           .seed = kSeed,
                           .stage_wire = configuration.wire,
                           .more = kLamp + configuration.radiometers,
                           .history = 10'000 * (number + 1)}};
  bench.bring_up_daemon();
  const long scan = bench.submit(plan_text({.theta_i_deg = "[0, 30, 60]",
                                            .theta_r_deg = "[10, 40, 60]",
                                            .phi_r_deg = "[0, 90, 180]",
                                            .target_snr = 2000.0,
                                            .block_s = 3600,
                                            .dark_s = 3600}));
  EXPECT_EQ(bench.wait_for_state(scan, {"done", "failed", "aborted", "holding"}), "done")
      << bench.holds_of(scan) << bench.log();
  const auto has_brdf = [&] { return count_of(all_events(bench, bench.daemon().port()), "brdf-computed") > 0; };
  EXPECT_TRUE(eventually(has_brdf, kStepDeadline)) << bench.log();
  EXPECT_EQ(bench.end_daemon(), 0) << bench.log();
  const StoreCopy store(bench.files().store, bench.folder());
  const bool has_meter_as_detector = configuration.radiometers.find("\"detector\"") != std::string::npos;
  const bool has_monitor = !configuration.radiometers.empty();
  const long readings = store.count("reading");
  EXPECT_EQ(store.count("power_reading WHERE role = 'detector'") > 0, has_meter_as_detector);
  EXPECT_EQ(store.count("power_reading WHERE role = 'monitor'"), has_monitor ? readings : 0);
  return store.brdf(scan);
}

TEST(Detectors, MeasureTheSameOverAnyWireWithAnyDetectorAndMonitor) {
  std::vector<std::map<long, StoredValue>> runs;
  for (const Configuration& configuration : kConfigurations) {
    SCOPED_TRACE(configuration.name);
    runs.push_back(measure(configuration, std::ssize(runs)));
    ASSERT_FALSE(runs.back().empty());
  }

  for (std::size_t a = 0; a < runs.size(); ++a) {
    for (std::size_t b = a + 1; b < runs.size(); ++b) {
      SCOPED_TRACE(kConfigurations[a].name + " against " + kConfigurations[b].name);
      const bool both_by_camera = a != 2 && b != 2;
      const ChiSquare chi = agreement(runs[a], runs[b], [&](const std::string& component) {
        return !is_common_to_the_bench(component) && !(both_by_camera && component.starts_with("linearity"));
      });
      std::cout << kConfigurations[a].name << " against " << kConfigurations[b].name << ": chi-square " << chi.value
                << ", " << chi.degrees_of_freedom << " degrees of freedom, p " << chi.p << "\n";
      EXPECT_EQ(chi.degrees_of_freedom, std::ssize(runs[0]));
      EXPECT_GT(chi.p, kLeastP) << "chi-square " << chi.value;
      EXPECT_LT(chi.p, kMostP) << "chi-square " << chi.value;
    }
  }
}

}  // namespace
}  // namespace gonio::test
