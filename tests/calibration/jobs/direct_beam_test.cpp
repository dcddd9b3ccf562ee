// The direct beam of the simulator, and a sample measured by it without any standard: attenuator, stop and zeros of the
// arms are other than their certificates say, each time anew.
#include "calibration/jobs/direct_beam.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "base/utc_text.h"
#include "calibration/calibrate.h"
#include "calibration/jobs/found_model.h"
#include "calibration/reference_standard.h"
#include "sim/scene/papers.h"
#include "sim/scene/read_scene.h"
#include "tests/calibration/jobs/job_bench.h"

namespace gonio::calibration {
namespace {

using testing::HasSubstr;

constexpr double kBesideDeg = 0.1;
constexpr double kBeamExposure = 0.016;
constexpr double kSampleExposure = 0.064;
const Measured<double> kPassed{1e-3, 2e-6};

sim::Scene scene_with_stop(std::uint64_t seed) {
  sim::Scene scene = sim::read_scene(GONIO_SCENES "/lambertian.toml").value();
  scene.seed = seed;
  scene.time_scale = 1.0;
  scene.effects.overlap = sim::OverlapSpec{.spot_radius = millimetres(3.0), .field_radius = millimetres(6.0)};
  scene.effects.stop = sim::StopSpec{.radius = {millimetres(10.0), millimetres(0.01)},
                                     .distance = {millimetres(500.0), millimetres(0.25)}};
  scene.stage.open_mm = 180.0;
  scene.filters.push_back({.slot = 4, .centroid = nanometres(568.0), .fwhm = nanometres(10.0), .attenuation = kPassed});
  return scene;
}

Geometry direction(double theta_i, double theta_r, double phi_r) {
  return {.theta_i = degrees(theta_i), .phi_i = {}, .theta_r = degrees(theta_r), .phi_r = degrees(phi_r)};
}

// What the daemon is told of it.
InstrumentModel told(const sim::Scene& scene) {
  InstrumentModel model = test::told_model(scene);
  auto& beams = model.overlap.emplace();
  beams.spot_radius = {scene.effects.overlap->spot_radius, {}};
  beams.field_radius = {scene.effects.overlap->field_radius, {}};
  auto& absolute = model.absolute.emplace();
  absolute.aperture_radius = scene.effects.stop->radius;
  absolute.aperture_distance = scene.effects.stop->distance;
  return model;
}

void read_beam(test::JobBench& bench, double beside_deg = kBesideDeg, double exposure_s = kBeamExposure) {
  const double along_phi = beside_deg / std::sin(in_radians(degrees(100.0)));
  const std::array places{direction(80, 100, 180), direction(80, 100 - beside_deg, 180),
                          direction(80, 100 + beside_deg, 180), direction(80, 100, 180 - along_phi),
                          direction(80, 100, 180 + along_phi)};
  for (int repeat = 0; repeat < 3; ++repeat) {
    for (const Geometry& g : places) bench.item(bench.plan(g), g, Target::Sample, {exposure_s});
  }
}

// The readings of a job, or of the sample after it: one bench, so that no noise is the same twice.
ScanReadings part(const ScanReadings& all, bool is_beam) {
  ScanReadings some{.reference_mode = ReferenceMode::Absolute};
  for (const PlannedPoint& point : all.points) {
    if ((point.geometry.theta_r > degrees(90.0)) == is_beam) some.points.push_back(point);
  }
  for (const RawReading& reading : all.readings) {
    const bool is_wanted = !reading.point_index || std::ranges::any_of(some.points, [&](const PlannedPoint& point) {
      return point.index == *reading.point_index;
    });
    if (is_wanted) some.readings.push_back(reading);
  }
  return some;
}

TEST(DirectBeamJob, MakesAMeasurementWithoutAStandardWhoseUncertaintyHolds) {
  constexpr int kRepetitions = 200;
  constexpr std::uint64_t kFirstSeed = 7300;
  const std::array points{direction(30, 0, 180), direction(30, 40, 180), direction(30, 60, 90)};
  // No seed changes what is told of the standard, and nothing of it counts.
  const auto standard =
      ReferenceStandard::parse(sim::reference_toml(scene_with_stop(kFirstSeed).reference), "reference.toml");
  ASSERT_TRUE(standard) << describe(standard.error());
  std::array<double, 3> held{};
  std::array<double, 3> z2{};
  double relative_u = 0.0;
  for (int k = 0; k < kRepetitions; ++k) {
    const sim::Scene scene = scene_with_stop(kFirstSeed + static_cast<std::uint64_t>(k));
    const sim::ReadingLevel instrument(scene);
    test::JobBench bench(instrument, {kBeamExposure, kSampleExposure});
    read_beam(bench);
    for (const Geometry& g : points) bench.item(bench.plan(g), g, Target::Sample, {kSampleExposure, kSampleExposure});
    const ScanReadings all = bench.finish();

    const auto found = fit_direct_beam(part(all, true), told(scene), {{nanometres(568.0), kPassed}});
    ASSERT_TRUE(found) << describe(found.error());
    const auto model = with_found(told(scene), *found);
    ASSERT_TRUE(model) << describe(model.error());
    const auto calibrated =
        calibrate(part(all, false), *model, *standard, utc_from_iso8601("2026-06-01T00:00Z").value());

    ASSERT_TRUE(calibrated) << describe(calibrated.error());
    ASSERT_EQ(calibrated->points.size(), points.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
      const CalibratedPoint& point = calibrated->points[p];
      const double error = in_per_steradian(point.value - instrument.truth().sample(points[p]));
      held[p] += std::abs(error) <= in_per_steradian(point.budget.expanded) ? 1.0 / kRepetitions : 0.0;
      z2[p] += std::pow(error / in_per_steradian(point.budget.u), 2) / kRepetitions;
      relative_u += point.budget.u / point.value / (kRepetitions * points.size());
    }
  }
  std::printf("absolute, seeds %llu+%d: U held the truth %.1f, %.1f, %.1f %%; RMS z %.2f, %.2f, %.2f; u %.2f %%\n",
              static_cast<unsigned long long>(kFirstSeed), kRepetitions, 100.0 * held[0], 100.0 * held[1],
              100.0 * held[2], std::sqrt(z2[0]), std::sqrt(z2[1]), std::sqrt(z2[2]), 100.0 * relative_u);

  // 95.45 % of 200: the binomial's 3 sd are 4.4 %; those of an RMS of 200 are 15 %.
  for (std::size_t p = 0; p < points.size(); ++p) {
    EXPECT_NEAR(held[p], 0.9545, 0.044) << p;
    EXPECT_NEAR(std::sqrt(z2[p]), 1.0, 0.15) << p;
  }
  EXPECT_LT(relative_u, 0.006);
}

TEST(DirectBeamJob, SaysEachWavelengthsBeamWithItsAttenuatorAndTheModelTakesIt) {
  sim::Scene scene = scene_with_stop(5);
  scene.draws_errors = false;
  const sim::ReadingLevel instrument(scene);
  test::JobBench bench(instrument, {kBeamExposure});
  read_beam(bench);

  const auto found = fit_direct_beam(bench.finish(), told(scene), {{nanometres(568.0), kPassed}});

  ASSERT_TRUE(found) << describe(found.error());
  const auto q = found->place_of("direct_beam_q_568nm");
  const auto passed = found->place_of("direct_beam_attenuation_568nm");
  ASSERT_TRUE(q && passed);
  // White's 700 000 electrons a second at 4 e/DN; the beam's quarter of the field over the stop's solid angle,
  // attenuated.
  const double expected = 175000.0 * 0.25 * (250000.0 + 100.0) / 100.0 * 1e-3;
  EXPECT_NEAR(found->values[*q].value, expected, 5.0 * found->u(*q));
  EXPECT_LT(found->u(*q) / expected, 2e-3);
  EXPECT_EQ(found->u(*passed), kPassed.u);
  const std::vector<DirectBeam> beams = with_found(told(scene), *found)->absolute->beams;
  ASSERT_EQ(beams.size(), 1U);
  EXPECT_NEAR(in_nanometres(beams[0].wavelength), 568.0, 1e-9);
  EXPECT_EQ(beams[0].q.value, found->values[*q].value);
  EXPECT_DOUBLE_EQ(beams[0].q.u, found->u(*q));
  EXPECT_EQ(beams[0].attenuation.value, kPassed.value);
  EXPECT_GT(beams[0].mean_net_dn, 1000.0);
  EXPECT_FALSE(with_found(test::told_model(scene), *found)->absolute) << "without a stop nothing is absolute";
}

// A stop of 4 mm takes in the beam of 3 mm in the middle; 0.2 deg beside it, 1.7 mm, no longer all of it.
TEST(DirectBeamJob, RefusesABeamThatIsNotWholeOnTheDetector) {
  sim::Scene scene = scene_with_stop(6);
  scene.effects.stop->radius = {millimetres(4.0), {}};
  const sim::ReadingLevel instrument(scene);
  constexpr double kTooFarDeg = 0.2;
  constexpr double kShort = 0.002;  // a smaller stop stands for a brighter beam of the same light
  test::JobBench bench(instrument, {kShort});
  read_beam(bench, kTooFarDeg, kShort);
  const ScanReadings scan = bench.finish();

  const auto found = fit_direct_beam(scan, told(scene), {{nanometres(568.0), kPassed}});

  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::IncompleteData);
  EXPECT_THAT(describe(found.error()), HasSubstr("beside its middle"));
}

TEST(DirectBeamJob, RefusesABeamWithoutTheCertificateOfItsAttenuator) {
  const sim::Scene scene = scene_with_stop(7);
  const sim::ReadingLevel instrument(scene);
  test::JobBench bench(instrument, {kBeamExposure});
  read_beam(bench);
  const ScanReadings scan = bench.finish();

  EXPECT_THAT(describe(fit_direct_beam(scan, told(scene), {}).error()), HasSubstr("no attenuator"));
  EXPECT_THAT(describe(fit_direct_beam({}, told(scene), {}).error()), HasSubstr("no readings"));
}

}  // namespace
}  // namespace gonio::calibration
