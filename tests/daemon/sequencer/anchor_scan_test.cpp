// A scan in anchor mode by the whole sequencer into a real store in manual time: the standard is visited before, during
// and after at one geometry, the sample alone at the others, and the BRDF holds its U over a lamp that nobody watches.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "calibration/calibrate.h"
#include "daemon/planner/anchor.h"
#include "tests/calibration/reference_text.h"
#include "tests/daemon/sequencer/scan_rig.h"

namespace gonio::daemon {
namespace {

using test::bench_plan;
using test::ScanRig;

constexpr int kSeeds = 24;
constexpr double kDriftPerHour = -0.02;
constexpr double kSpotMm = 6.0;
constexpr double kFieldMm = 4.0;
constexpr double kRelativeU = 0.01;  // of both radii
constexpr Duration kExposure = std::chrono::milliseconds(4);
const UtcTime kToday{std::chrono::sys_days{std::chrono::year{2026} / 3 / 1}};

Instrument instrument_with_beams() {
  Instrument instrument = test::bench_instrument();
  for (const auto axis : {stage::Axis::ThetaI, stage::Axis::ThetaR, stage::Axis::PhiR, stage::Axis::PhiI}) {
    instrument.stage.axes[stage::index_of(axis)].speed = 0.5;
    instrument.stage.axes[stage::index_of(axis)].acceleration = 1.0;
  }
  auto& beams = instrument.model.overlap.emplace();
  beams.spot_radius = {millimetres(kSpotMm), millimetres(kSpotMm * kRelativeU)};
  beams.field_radius = {millimetres(kFieldMm), millimetres(kFieldMm * kRelativeU)};
  return instrument;
}

// At normal incidence; the field is longer than the spot from 48 deg on.
api::Plan anchored_plan() {
  api::Plan plan = bench_plan({0}, {20, 25, 30, 35, 40, 50, 55, 60, 65, 70, 75, 80}, {90});
  plan.target_snr = 2000;
  plan.exposures = {kExposure};
  plan.reference_mode = api::ReferenceMode::Anchor;
  plan.reference_every = std::chrono::minutes(2);
  return plan;
}

calibration::ReferenceStandard exact_white() {
  calibration::ReferenceText text;
  text.entries = "[[certificate.entries]]\nwavelength_nm = 568.0\nreflectance = 0.99\nuncertainty = 1e-9\n";
  text.shape_extra = "u_integral = 1e-9\n";
  auto parsed = calibration::ReferenceStandard::parse(text.text(), "white.toml");
  EXPECT_TRUE(parsed) << describe(parsed.error());
  return std::move(parsed).value();
}

double relative_to_white(double theta_r_deg) {
  return 0.3 + 0.005 * theta_r_deg;
}

// The lit part of the field, over the whole of it, for radii a of the spot (a circle) and b of the field (an ellipse).
double lit_part(double theta_r_deg, double a, double b) {
  const double p = b / std::cos(theta_r_deg * std::numbers::pi / 180.0);
  if (p <= a) return 1.0;
  const double x = std::sqrt((a * a - b * b) / (1.0 - b * b / (p * p)));
  const double y = std::sqrt(a * a - x * x);
  const double area = 2.0 * (a * a * std::atan2(y, x) + p * b * (std::numbers::pi / 2.0 - std::atan2(y / b, x / p)));
  return area / (std::numbers::pi * p * b);
}

struct Tally {
  double held = 0.0;
  double chi2 = 0.0;
  double points = 0.0;
  double mixed = 0.0;
};

class AnchoredScan : public testing::Test {
 protected:
  // What the instrument does, whatever it is told: its radii are drawn about the stated ones.
  void light(ScanRig& rig, unsigned seed) {
    engine_.seed(seed);
    const double a = kSpotMm * (1.0 + kRelativeU * normal_(engine_));
    const double b = kFieldMm * (1.0 + kRelativeU * normal_(engine_));
    rig.world.rate_dn_per_s = [this, a, b](double theta_r, bool is_reference) {
      const double f = is_reference ? 1.0 : relative_to_white(theta_r);
      const double net_dn = 300'000.0 * f * lit_part(theta_r, a, b) * in_seconds(kExposure);
      return (net_dn + std::sqrt((net_dn / 4.0 + 2.25) / 450.0) * normal_(engine_)) / in_seconds(kExposure);
    };
    const Instant start = rig.clock().now();
    rig.world.gain = [start](Instant now) { return 1.0 + kDriftPerHour * in_seconds(now - start) / 3600.0; };
  }

  void count(ScanRig& rig, ScanId id, const Instrument& told, Tally& tally) {
    const auto reader = StoreReader::open(rig.store_path());
    ASSERT_TRUE(reader) << describe(reader.error());
    const auto readings = (*reader)->readings(id, told.stage);
    ASSERT_TRUE(readings) << describe(readings.error());
    const auto scan = calibration::calibrate(*readings, told.model, exact_white(), kToday);
    ASSERT_TRUE(scan) << describe(scan.error());
    ASSERT_EQ(scan->points.size(), readings->points.size());
    for (const auto& point : scan->points) {
      const double truth = 0.99 / std::numbers::pi * relative_to_white(in_degrees(point.geometry.theta_r));
      const double error = point.value.si() - truth;
      tally.held += std::abs(error) <= point.budget.expanded.si() ? 1.0 : 0.0;
      tally.chi2 += std::pow(2.0 * error / point.budget.expanded.si(), 2);
      tally.mixed += has(point.flags, calibration::PointFlag::Mixed) ? 1.0 : 0.0;
      tally.points += 1.0;
    }
  }

  std::mt19937 engine_{1};
  std::normal_distribution<double> normal_;
};

TEST_F(AnchoredScan, CompletesWithoutAnyItemOfTheReference) {
  ScanRig rig(instrument_with_beams());
  light(rig, 1);

  const ScanId id = rig.submit(anchored_plan());
  rig.run_to_rest();

  ASSERT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(rig.info(id).counts.items, 13) << "twelve of the plan and the anchor";
  EXPECT_EQ(rig.info(id).counts.accepted, 13);
  EXPECT_EQ(rig.count("SELECT count(*) FROM item WHERE target = 'reference'"), 0);
  EXPECT_GE(rig.info(id).counts.reference_visits, 3) << "before, during and after";
  EXPECT_EQ(rig.count("SELECT count(DISTINCT point_index) FROM visit_level"), 1);
  EXPECT_EQ(
      rig.count("SELECT count(*) FROM visit_level JOIN point USING (scan_id, point_index) WHERE theta_r_deg <> 45"), 0);
}

TEST_F(AnchoredScan, GoesOnWithItsVisitsAfterTheDaemonWasKilled) {
  ScanRig rig(instrument_with_beams());
  light(rig, 2);
  const ScanId id = rig.submit(anchored_plan());
  ASSERT_TRUE(rig.run_until([&] { return rig.count("SELECT count(*) FROM item") >= 5; }));

  rig.kill();
  rig.start();
  rig.run_to_rest();

  ASSERT_EQ(rig.state_of(id), ScanState::Done);
  EXPECT_EQ(rig.info(id).counts.accepted, 13);
  EXPECT_EQ(rig.info(id).policy.reference_mode, api::ReferenceMode::Anchor);
  EXPECT_EQ(rig.count("SELECT count(*) FROM item WHERE target = 'reference'"), 0);
}

TEST_F(AnchoredScan, HoldsItsUWithRadiiAndALampThatNobodyKnowsExactly) {
  Tally tally;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ScanRig rig(instrument_with_beams());
    light(rig, seed);
    const ScanId id = rig.submit(anchored_plan());
    rig.run_to_rest();
    ASSERT_EQ(rig.state_of(id), ScanState::Done);
    count(rig, id, instrument_with_beams(), tally);
  }

  std::printf("anchor: %.1f %% held, chi2/n %.2f, %.0f %% of %.0f points mixed\n", 100.0 * tally.held / tally.points,
              tally.chi2 / tally.points, 100.0 * tally.mixed / tally.points, tally.points);
  // Mixed points share two radii: 24 draws of two components, so the share's standard error is about 3 %.
  EXPECT_GE(tally.held / tally.points, 0.9545 - 0.09);
  EXPECT_LE(tally.chi2 / tally.points, 1.8);
  EXPECT_GE(tally.chi2 / tally.points, 0.2);
  EXPECT_NEAR(tally.mixed / tally.points, 7.0 / 13.0, 0.08);
}

TEST_F(AnchoredScan, IsWrongByTheOverlapWhereThatIsNotStated) {
  Instrument told = instrument_with_beams();
  told.model.overlap.reset();
  Tally tally;
  ScanRig rig(instrument_with_beams());
  light(rig, 3);
  const ScanId id = rig.submit(anchored_plan());
  rig.run_to_rest();

  count(rig, id, told, tally);

  EXPECT_LT(tally.held / tally.points, 0.7);
}

}  // namespace
}  // namespace gonio::daemon
