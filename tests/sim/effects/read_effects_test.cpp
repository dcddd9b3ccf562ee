#include "sim/scene/read_effects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/scene/papers.h"
#include "sim/scene/read_scene.h"
#include "tests/sim/effects/effects_bench.h"
#include "tests/support/process.h"

namespace gonio::sim::test {
namespace {

using gonio::test::TemporaryFolder;
using gonio::test::write_text;

Result<Scene> read_with(const std::string& sections) {
  const TemporaryFolder folder;
  write_text(folder / "x.toml", "[scene]\nname = \"x\"\nbench = \"" + std::string(GONIO_SCENES) +
                                    "/bench.toml\"\n[sample]\nmodel = \"lambertian\"\nrho = 0.5\n" + sections);
  return read_scene(folder / "x.toml");
}

TEST(ReadEffects, KnowsEveryEffectOfTheReadme) {
  const auto scene = read_with(
      "[effects]\nexposure_offset_s = 2e-4\n"
      "[effects.cones]\nsource_half_deg = 1.0\ndetector_half_deg = 2.0\ntolerance = 1e-4\n"
      "[effects.overlap]\nspot_radius_mm = 8.0\nfield_radius_mm = 5.0\nsample_radius_mm = 20.0\n"
      "[effects.mounting]\nsource_distance_mm = 700.0\n"
      "[effects.mounting.sample]\nlean_to_phi_0_deg = 0.5\nlean_to_phi_90_deg = -0.25\nheight_mm = 1.5\n"
      "[effects.encoder.theta_i]\namplitude_deg = 0.01\nperiod_deg = 90.0\nphase_deg = 10.0\n"
      "[effects.backlash]\ntheta_r_deg = 0.05\ncarriage_mm = 0.1\n"
      "[effects.polarisation]\nsource_degree = 0.3\ndetector_plane_deg = 45.0\n"
      "[effects.stray]\nambient_electrons_per_s = 100.0\nsource_share = 0.001\ninternal_share = 0.002\n"
      "[effects.response]\nquadratic = -0.01\nknee = 0.9\nsaturation = 1.0\n"
      "[effects.dark_drift]\nper_hour = 0.1\ncorrelation_s = 300.0\n"
      "[effects.speckle]\ncontrast = 0.05\ngrain_px = 3\n");

  ASSERT_TRUE(scene.has_value()) << describe(scene.error());
  const EffectsSpec& effects = scene->effects;
  EXPECT_EQ(effects.exposure_offset_s, 2e-4);
  EXPECT_DOUBLE_EQ(in_degrees(effects.cones->detector_half), 2.0);
  EXPECT_DOUBLE_EQ(in_millimetres(*effects.overlap->sample_radius), 20.0);
  EXPECT_FALSE(effects.overlap->reference_radius.has_value());
  EXPECT_DOUBLE_EQ(in_degrees(effects.mounting->sample.lean_90), -0.25);
  EXPECT_DOUBLE_EQ(in_millimetres(effects.mounting->source_distance), 700.0);
  EXPECT_EQ(effects.mounting->reference.height.si(), 0.0);
  EXPECT_DOUBLE_EQ(in_degrees(effects.encoder[stage::index_of(Axis::ThetaI)]->period), 90.0);
  EXPECT_FALSE(effects.encoder[stage::index_of(Axis::ThetaR)].has_value());
  EXPECT_EQ(scene->stage.axes[stage::index_of(Axis::ThetaR)].backlash, 0.05);
  EXPECT_EQ(scene->stage.axes[stage::index_of(Axis::Carriage)].backlash, 0.1);
  EXPECT_EQ(effects.polarisation->source_degree, 0.3);
  EXPECT_EQ(effects.stray->internal_share, 0.002);
  EXPECT_EQ(effects.response->knee, 0.9);
  EXPECT_EQ(effects.dark_drift->correlation_s, 300.0);
  EXPECT_EQ(scene->detector.speckle.grain_px, 3);
}

TEST(ReadEffects, HasNoneThatIsNotNamed) {
  const auto scene = read_with("");

  ASSERT_TRUE(scene.has_value()) << describe(scene.error());
  const EffectsSpec& effects = scene->effects;
  EXPECT_FALSE(effects.cones || effects.overlap || effects.mounting || effects.polarisation || effects.stray ||
               effects.response || effects.dark_drift);
  for (const auto& error : effects.encoder) EXPECT_FALSE(error.has_value());
  for (const AxisSpec& axis : scene->stage.axes) EXPECT_EQ(axis.backlash, 0.0);
  EXPECT_EQ(effects.exposure_offset_s, 0.0);
  EXPECT_EQ(scene->detector.speckle.contrast, 0.0);
}

TEST(ReadEffects, NamesTheKeyThatItDoesNotKnow) {
  const auto effect = read_with("[effects.cone]\nsource_half_deg = 1.0\n");
  const auto key = read_with("[effects.cones]\nsource_half_cone_deg = 1.0\n");

  ASSERT_FALSE(effect.has_value());
  EXPECT_EQ(effect.error().code, ErrorCode::UnknownKey);
  EXPECT_THAT(effect.error().limit, testing::HasSubstr("cones"));
  ASSERT_FALSE(key.has_value());
  EXPECT_EQ(key.error().code, ErrorCode::UnknownKey);
  EXPECT_THAT(key.error().limit, testing::HasSubstr("source_half_deg"));
}

TEST(ReadEffects, RefusesWhatNoInstrumentDoes) {
  for (const char* text :
       {"[effects.cones]\nsource_half_deg = 45.0\n", "[effects.overlap]\nspot_radius_mm = 5.0\n",
        "[effects.response]\nknee = 0.9\nsaturation = 0.8\n", "[effects.speckle]\ncontrast = 1.5\n",
        "[effects.polarisation]\nsource_degree = 1.1\n", "[effects]\nexposure_offset_s = -0.5\n",
        "[effects.encoder.carriage]\namplitude_deg = 0.1\n", "[effects.backlash]\ntheta_i_mm = 0.1\n"})
    EXPECT_FALSE(read_with(text).has_value()) << text;
}

TEST(ReadTold, SaysToTheDaemonWhatTheSceneStates) {
  const auto scene = read_with(
      "[told]\nu_linearity = 0.02\nexposure_offset_s = 4e-4\nu_exposure_offset_s = 1e-4\nu_zero_theta_i_deg = 0.5\n"
      "source_half_cone_deg = 3.0\n");
  ASSERT_TRUE(scene.has_value()) << describe(scene.error());

  const std::string text = instrument_toml(*scene, {});

  EXPECT_THAT(text, testing::HasSubstr("u_linearity = 0.02\n"));
  EXPECT_THAT(text, testing::HasSubstr("\nexposure_offset_s = 0.0004\n"));
  EXPECT_THAT(text, testing::HasSubstr("u_exposure_offset_s = 0.0001\n"));
  EXPECT_THAT(text, testing::HasSubstr("u_zero_theta_i_deg = 0.5\n"));
  EXPECT_THAT(text, testing::HasSubstr("source_half_cone_deg = 3\n"));
  EXPECT_THAT(text, testing::HasSubstr("u_zero_theta_r_deg = 0.02\n")) << "the rest as the bench has it";
}

}  // namespace
}  // namespace gonio::sim::test
