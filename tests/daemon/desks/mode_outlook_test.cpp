#include "daemon/desks/mode_outlook.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "daemon/planner/planner.h"
#include "tests/calibration/reference_text.h"
#include "tests/daemon/support/bench_instrument.h"

namespace gonio::daemon {
namespace {

using test::bench_instrument;
using test::bench_plan;

calibration::ReferenceStandard white() {
  calibration::ReferenceText text;
  text.modes = "[[shape.modes]]\nname = \"limb\"\nkind = \"limb\"\nu = 0.01\n";
  auto parsed = calibration::ReferenceStandard::parse(text.text(), "white.toml");
  EXPECT_TRUE(parsed) << describe(parsed.error());
  return std::move(parsed).value();
}

Instrument bench_with_beams(double spot_mm, double field_mm) {
  Instrument instrument = bench_instrument();
  calibration::InstrumentModel& model = instrument.model;
  model.angles = {.u_zero_theta_i = degrees(0.03),
                  .u_zero_theta_r = degrees(0.03),
                  .u_zero_phi_r = degrees(0.03),
                  .u_repeat = degrees(0.002)};
  model.lamp.u_after_monitor = 0.001;
  model.lamp.u_reproducibility = 0.0005;
  auto& beams = model.overlap.emplace();
  beams.spot_radius = {millimetres(spot_mm), millimetres(0.01 * spot_mm)};
  beams.field_radius = {millimetres(field_mm), millimetres(0.01 * field_mm)};
  auto& absolute = model.absolute.emplace();
  absolute.beams = {{.wavelength = nanometres(568.0), .q = {1.0, 0.001}, .attenuation = {1e-4, 5e-7}}};
  absolute.aperture_radius = {millimetres(10.0), millimetres(0.02)};
  absolute.aperture_distance = {millimetres(500.0), millimetres(0.5)};
  return instrument;
}

std::vector<ModeOutlook> outlooks(const api::Plan& plan, const Instrument& instrument) {
  const auto planned = expand(plan, instrument);
  EXPECT_TRUE(planned) << describe(planned.error());
  return mode_outlooks(plan, *planned, instrument, white());
}

api::Plan half_space() {
  std::vector<double> theta_r;
  for (int k = 0; k <= 15; ++k) theta_r.push_back(5.0 * k);
  std::vector<double> phi_r;
  for (int k = 0; k <= 12; ++k) phi_r.push_back(15.0 * k);
  api::Plan plan = bench_plan({0, 30, 60}, theta_r, phi_r);
  plan.block = std::chrono::minutes(15);
  return plan;
}

TEST(ModeOutlook, SaysWhatEachModeCostsAndGivesBeforeTheScan) {
  const auto found = outlooks(half_space(), bench_with_beams(6.0, 4.0));

  ASSERT_EQ(found.size(), 3U);
  for (const ModeOutlook& one : found) {
    std::printf("mode %d: %.0f s, U median %.2f %%, worst %.2f %% (%s), %d of %d mixed%s\n", static_cast<int>(one.mode),
                in_seconds(one.time), 100.0 * one.median_relative_u, 100.0 * one.worst_relative_u, one.dominant.c_str(),
                one.mixed, one.looked_at, one.refused.c_str());
    EXPECT_EQ(one.refused, "");
    EXPECT_GT(one.looked_at, 100);
  }
  const ModeOutlook& same = found[0];
  const ModeOutlook& anchor = found[1];
  const ModeOutlook& absolute = found[2];
  EXPECT_LT(in_seconds(anchor.time), 0.65 * in_seconds(same.time));
  EXPECT_LT(absolute.time, anchor.time);
  EXPECT_GT(anchor.worst_relative_u, same.worst_relative_u) << "cosines and overlap no longer cancel";
  EXPECT_GT(anchor.mixed, 0);
  EXPECT_NE(anchor.dominant, "");
}

TEST(ModeOutlook, InRadianceGeometryAnAnchorAddsTheCosineOnly) {
  const auto found = outlooks(bench_plan({0, 60}, {20, 40}, {90}), bench_with_beams(60.0, 4.0));

  EXPECT_EQ(found[1].mixed, 0);
  // tan 60 x 0.03 deg = 0.09 %, at k = 2 beside a certificate of 0.6 %.
  EXPECT_LT(found[1].worst_relative_u, 1.1 * found[0].worst_relative_u);
}

TEST(ModeOutlook, SaysWhyAModeCannotBeHad) {
  Instrument instrument = bench_with_beams(6.0, 4.0);
  instrument.model.absolute.reset();
  api::Plan plan = half_space();
  plan.anchor.theta_r = degrees(88.0);

  const auto found = outlooks(plan, instrument);

  EXPECT_EQ(found[0].refused, "");
  EXPECT_NE(found[1].refused, "");
  EXPECT_EQ(found[2].refused, "no direct beam");
}

}  // namespace
}  // namespace gonio::daemon
