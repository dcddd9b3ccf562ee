// Frames of a simulated camera whose pixels are uneven and some of them bad, reduced with maps and without, up to the
// ratio that a BRDF is made of.
#include <gtest/gtest.h>

#include <cmath>

#include "calibration/dark_history.h"
#include "calibration/frame_reducer.h"
#include "calibration/normalised_reading.h"
#include "sim/devices/detector_noise.h"
#include "sim/devices/pixel_pattern.h"

namespace gonio::calibration {
namespace {

constexpr std::uint64_t kSeed = 11;
constexpr double kExposure_s = 0.01;
constexpr double kReferenceElectrons = 8000.0;  // 2000 DN
constexpr double kTrueRatio = 0.25;             // f of the sample over f of the reference

sim::DetectorSpec uneven_camera() {
  sim::DetectorSpec spec;
  spec.electrons_per_dn = 4.0;
  spec.read_noise_dn = 1.5;
  spec.offset_dn = 64.0;
  spec.flat_sigma = 0.05;
  spec.bad_fraction = 0.05;  // full at 409 DN: they follow the sample's light and not the reference's
  return spec;
}

DetectorMaps maps_of(const sim::DetectorSpec& spec) {
  const sim::PixelPattern pattern(spec, kSeed);
  DetectorMaps maps;
  maps.width = spec.width_px;
  maps.height = spec.height_px;
  for (int y = 0; y < spec.height_px; ++y) {
    for (int x = 0; x < spec.width_px; ++x) {
      maps.flat.push_back(static_cast<float>(pattern.response(x, y)));
      maps.bad.push_back(pattern.is_bad(x, y) ? 1 : 0);
    }
  }
  return maps;
}

/// Dark, reference and sample as one camera sees them, a frame each.
class SimulatedMaps : public testing::Test {
 protected:
  NormalisedReading normalised(double electrons, const std::optional<DetectorMaps>& maps) {
    const DetectorModel model{.electrons_per_dn = 4.0, .read_noise_dn = std::sqrt(1.5 * 1.5 + 1.0 / 12.0)};
    ScanReadings scan;
    scan.readings.push_back(reading(Target::Dark, 0.0, maps, model));
    const DarkHistory darks(scan, model);
    const auto result = normalise(reading(Target::Sample, electrons, maps, model), darks, model);
    EXPECT_TRUE(result) << describe(result.error());
    return *result;
  }

  RawReading reading(Target target, double electrons, const std::optional<DetectorMaps>& maps,
                     const DetectorModel& model) {
    const sim::Aperture circle = sim::aperture_of(spec_);
    const auto reducer = FrameReducer::prepare(spec_.width_px, spec_.height_px, 4095,
                                               {circle.centre_x_px, circle.centre_y_px, circle.radius_px}, maps, model);
    EXPECT_TRUE(reducer) << describe(reducer.error());
    RawReading out{.target = target, .at = Instant(Duration(++exposures_))};
    for (int k = 0; k < 8; ++k) {
      const sim::Exposure exposure{.number = ++exposures_, .light_electrons = electrons};
      const auto frame = reducer->reduce(sim::render_frame(spec_, exposure, kSeed), kExposure_s, 0.0);
      EXPECT_TRUE(frame) << describe(frame.error());
      out.frames.push_back(
          RawFrame{.region = frame->raw, .reduced = frame->reduced, .exposure_s = kExposure_s, .monitor_mean = 1.0});
    }
    return out;
  }

  sim::DetectorSpec spec_ = uneven_camera();
  std::uint64_t exposures_ = 0;
};

TEST_F(SimulatedMaps, GiveTheRatioThatTheLightHas) {
  const auto maps = std::optional(maps_of(spec_));

  const NormalisedReading reference = normalised(kReferenceElectrons, maps);
  const NormalisedReading sample = normalised(kTrueRatio * kReferenceElectrons, maps);

  const double ratio = sample.q / reference.q;
  const double u = ratio * std::hypot(sample.u_noise / sample.q, reference.u_noise / reference.q);
  EXPECT_NEAR(ratio, kTrueRatio, 4.0 * u);
  EXPECT_LT(u / ratio, 2e-3);
}

TEST_F(SimulatedMaps, AreMissedWhereThereAreNone) {
  const NormalisedReading reference = normalised(kReferenceElectrons, std::nullopt);
  const NormalisedReading sample = normalised(kTrueRatio * kReferenceElectrons, std::nullopt);

  // One pixel in twenty shows 345 DN of the reference's 2000: its mean falls by 0.05 * 1655 / 2000 = 4 %, the ratio
  // rises.
  EXPECT_GT(sample.q / reference.q, kTrueRatio * 1.02);
}

// The scatter of pixels that a flat leaves is texture; what repeated frames scatter by is noise, with maps or without.
TEST_F(SimulatedMaps, LeaveTheNoiseThatTheModelStates) {
  const NormalisedReading reading = normalised(kReferenceElectrons, std::optional(maps_of(spec_)));

  const double chi2_per_dof = reading.frame_chi2 / reading.frame_dof;
  EXPECT_GT(chi2_per_dof, 0.08);  // seven degrees of freedom: outside of 0.085..3.5 once in 1000
  EXPECT_LT(chi2_per_dof, 3.5);
}

}  // namespace
}  // namespace gonio::calibration
