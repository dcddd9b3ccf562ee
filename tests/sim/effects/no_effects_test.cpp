// What a scene that names no effect reads: the numbers of before there were any, and no work for them.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "sim/devices/reading_level.h"
#include "sim/optics/speckle_pattern.h"
#include "sim/scene/read_scene.h"
#include "tests/sim/effects/effects_bench.h"

namespace gonio::sim::test {
namespace {

struct Recorded {
  const char* scene;
  int reading;
  double mean;
  double m2;
  double monitor;
};

// Recorded at revision 284bbdd, the last one without effects: 20 ms at four geometries, sample and reference in turn.
// The reference's means and m2 were recorded again when its shape was made to keep energy, which moved nothing else.
constexpr std::array kRecorded{
    Recorded{"wheat", 1, 0x1.46cbe6cb614e8p+11, 0x1.266ade4d1589dp+9, 0x1.fddfa730ca30cp-1},
    Recorded{"wheat", 2, 0x1.bec99ec448f87p+11, 0x1.7ea739df98dbap+9, 0x1.ff37adb18dfcep-1},
    Recorded{"wheat", 3, 0x1.b176239831326p+10, 0x1.a0c65992c6f06p+8, 0x1.ff51084ed3f61p-1},
    Recorded{"wheat", 4, 0x1.76dd1adf543c1p+11, 0x1.60a4b54a4ea63p+9, 0x1.004a973cb4cfap+0},
    Recorded{"wheat", 5, 0x1.d4c13b864ef8ap+10, 0x1.a729e6e15a28p+8, 0x1.fff98d428f9d6p-1},
    Recorded{"wheat", 6, 0x1.3dcc819784e2ap+11, 0x1.27ac5878df823p+9, 0x1.fee314c928cc1p-1},
    Recorded{"wheat", 7, 0x1.1401b6572fb6ap+10, 0x1.f8cda9569d35ap+7, 0x1.fe10949362d2fp-1},
    Recorded{"wheat", 8, 0x1.02b4d22356739p+11, 0x1.d5779cd31524bp+8, 0x1.fd4ba25bfbd54p-1},
    Recorded{"glint", 1, 0x1.44e460d1974e8p+7, 0x1.8bc272b5f74abp+4, 0x1.fddfa730ca30cp-1},
    Recorded{"glint", 2, 0x1.bec99ec448f87p+11, 0x1.7ea739df98dbap+9, 0x1.ff37adb18dfcep-1},
    Recorded{"glint", 3, 0x1.97bed1162ba86p+8, 0x1.5efc48d9f5902p+6, 0x1.ff51084ed3f61p-1},
    Recorded{"glint", 4, 0x1.76dd1adf543c1p+11, 0x1.60a4b54a4ea63p+9, 0x1.004a973cb4cfap+0},
    Recorded{"glint", 5, 0x1.0c3158921cca3p+7, 0x1.264722f191b9bp+4, 0x1.fff98d428f9d6p-1},
    Recorded{"glint", 6, 0x1.3dcc819784e2ap+11, 0x1.27ac5878df823p+9, 0x1.fee314c928cc1p-1},
    Recorded{"glint", 7, 0x1.8b79027dd5fa9p+6, 0x1.55131d68a0f8p+3, 0x1.fe10949362d2fp-1},
    Recorded{"glint", 8, 0x1.02b4d22356739p+11, 0x1.d5779cd31524bp+8, 0x1.fd4ba25bfbd54p-1},
    Recorded{"dark", 1, 0x1.03d2e947733e7p+6, 0x1.2c3f58f737d58p+1, 0x1.fddfa730ca30cp-1},
    Recorded{"dark", 2, 0x1.bec99ec448f87p+11, 0x1.7ea739df98dbap+9, 0x1.ff37adb18dfcep-1},
    Recorded{"dark", 3, 0x1.0280425c740b6p+6, 0x1.407fe6f48451bp+1, 0x1.ff51084ed3f61p-1},
    Recorded{"dark", 4, 0x1.76dd1adf543c1p+11, 0x1.60a4b54a4ea63p+9, 0x1.004a973cb4cfap+0},
    Recorded{"dark", 5, 0x1.032d4152305a1p+6, 0x1.2982d105df6dbp+1, 0x1.fff98d428f9d6p-1},
    Recorded{"dark", 6, 0x1.3dcc819784e2ap+11, 0x1.27ac5878df823p+9, 0x1.fee314c928cc1p-1},
    Recorded{"dark", 7, 0x1.01c4f41231278p+6, 0x1.2ecf66ad650a2p+1, 0x1.fe10949362d2fp-1},
    Recorded{"dark", 8, 0x1.02b4d22356739p+11, 0x1.d5779cd31524bp+8, 0x1.fd4ba25bfbd54p-1},
};

constexpr double kGeometries[4][3] = {{0, 45, 0}, {30, 60, 180}, {45, 0, 0}, {60, 75, 120}};

TEST(WithoutEffects, AReadingIsWhatItWasBeforeThereWereAny) {
  for (const Recorded& recorded : kRecorded) {
    SCOPED_TRACE(std::string(recorded.scene) + " " + std::to_string(recorded.reading));
    const auto scene = read_scene(std::string(GONIO_SCENES) + "/" + recorded.scene + ".toml");
    ASSERT_TRUE(scene.has_value()) << describe(scene.error());
    const auto& angles = kGeometries[(recorded.reading - 1) / 2];
    const auto number = static_cast<std::uint64_t>(recorded.reading);

    const ReadingAnswer answer =
        ReadingLevel(*scene).read({.target = recorded.reading % 2 == 1 ? Station::Sample : Station::Reference,
                                   .encoders = at_deg(angles[0], angles[1], angles[2]),
                                   .wavelength = nanometres(568.0),
                                   .exposure = scene->wall(0.02),
                                   .at_scene_s = 100.0 * recorded.reading,
                                   .move = number,
                                   .exposure_number = number});

    // Bit for bit on the machine that recorded them; another mathematical library may round otherwise.
    EXPECT_DOUBLE_EQ(answer.region.mean, recorded.mean);
    EXPECT_DOUBLE_EQ(answer.region.m2, recorded.m2);
    EXPECT_DOUBLE_EQ(answer.monitor.mean, recorded.monitor);
  }
}

TEST(WithoutEffects, LightIsTheBareFormulaToTheLastBit) {
  const Scene scene = scene_with(wheat());
  const Truth truth(scene);

  for (const auto& angles : kGeometries) {
    const Geometry g = at_deg(angles[0], angles[1], angles[2]);
    const double formula =
        kWhite * 1.0 * (std::numbers::pi * truth.sample(g).si()) * std::cos(g.theta_i.si()) * truth.placing(0);
    const LightRate rate = rate_of(scene, pose_at(g));
    EXPECT_EQ(rate.target, formula);
    EXPECT_EQ(rate.veil, 0.0);
    EXPECT_EQ(rate.ambient, 0.0);
  }
}

TEST(WithoutEffects, TheBrdfIsAskedOnce) {
  int calls = 0;
  const auto f = [&](const reflectance::Direction&, const reflectance::Direction&) {
    ++calls;
    return per_steradian(0.1);
  };

  const ConeAverage average = average_over_cones(ConeSpec{}, at_deg(30, 40, 100), f);

  EXPECT_EQ(calls, 1);
  EXPECT_EQ(average.evaluations, 1);
}

TEST(WithoutEffects, NoPlaceHasAPattern) {
  const Scene scene = quiet_scene();
  const Truth truth(scene);
  const LightPath path(scene, truth);
  const SpecklePattern none({}, 64, 64, scene.seed, 7);

  EXPECT_EQ(path.place(pose_at(at_deg(30, 40, 100))), 0U);
  EXPECT_EQ(none(3, 5), 1.0);
}

// The truth is the measurand: f at the directions that are asked for, whatever the instrument does to its readings.
TEST(WithoutEffects, AndWithThemTheTruthIsTheSame) {
  const Scene plain = scene_with(wheat());
  Scene busy = plain;
  busy.effects.cones = ConeSpec{.source_half = degrees(2.0), .detector_half = degrees(2.0)};
  busy.effects.mounting = MountingSpec{.sample = {.lean_0 = degrees(1.0), .height = millimetres(2.0)}};
  busy.effects.polarisation = PolarisationSpec{.source_degree = 1.0};
  const Geometry g = at_deg(30, 60, 120);

  EXPECT_EQ(Truth(busy).sample(g).si(), Truth(plain).sample(g).si());
}

}  // namespace
}  // namespace gonio::sim::test
