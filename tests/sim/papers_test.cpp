// The files that goniosim lays out, read by those who are to read them.
#include "sim/scene/papers.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "calibration/reference_standard.h"
#include "daemon/config/instrument.h"
#include "sim/scene/read_scene.h"
#include "sim/scene/spectralon_shape.h"
#include "tests/sim/bench.h"

namespace gonio::sim::test {
namespace {

Scene full_scene() {
  Scene scene = quiet_scene();
  scene.time_scale = 40.0;
  scene.detector.read_noise_dn = 1.5;
  scene.lamp.u_after_monitor = 0.0005;
  scene.lamp.correlation_s = 3600.0;
  scene.angles = {degrees(0.02), degrees(0.03), degrees(0.04), degrees(0.002)};
  scene.reference.u_integral = 0.001;
  scene.reference.modes = {{.kind = ModeKind::Limb, .u = 0.01},
                           {.kind = ModeKind::Opposition, .u = 0.005, .width = degrees(10.0)}};
  return scene;
}

TEST(InstrumentToml, IsReadByTheDaemonAndSaysEverythingInWallTime) {
  const Scene scene = full_scene();
  const std::string text = instrument_toml(scene, {.stage_port = 1234, .camera_address = "127.1.2.3"});

  const auto read = daemon::parse_instrument(text, "instrument.toml");

  ASSERT_TRUE(read.has_value()) << describe(read.error());
  EXPECT_EQ(read->stage_address.port, 1234);
  EXPECT_EQ(read->detector.address, "127.1.2.3");
  EXPECT_TRUE(read->stage.registers == scene.stage.registers);
  EXPECT_DOUBLE_EQ(read->stage.axis(stage::Axis::ThetaI).speed, 20.0 * 40.0);
  EXPECT_DOUBLE_EQ(read->stage.axis(stage::Axis::ThetaI).acceleration, 40.0 * 1600.0);
  EXPECT_NEAR(in_seconds(read->stage.axis(stage::Axis::ThetaI).settle), 0.1 / 40.0, 2e-9);
  EXPECT_NEAR(in_seconds(read->detector.longest_exposure), 0.512 / 40.0, 2e-9);
  EXPECT_DOUBLE_EQ(read->model.lamp.correlation_s, 90.0);
  EXPECT_DOUBLE_EQ(read->model.detector.read_noise_dn, std::sqrt(2.25 + 1.0 / 12.0));
  EXPECT_DOUBLE_EQ(in_degrees(read->model.angles.u_zero_phi_r), 0.04);
}

TEST(InstrumentToml, OfEverySceneThatIsShippedIsReadByTheDaemon) {
  for (const auto& entry : std::filesystem::directory_iterator(GONIO_SCENES)) {
    if (entry.path().stem() == "bench") continue;
    const auto scene = read_scene(entry.path().string());
    ASSERT_TRUE(scene.has_value()) << describe(scene.error());

    const auto read = daemon::parse_instrument(instrument_toml(*scene, {}), "instrument.toml");

    EXPECT_TRUE(read.has_value()) << entry.path() << ": " << describe(read.error());
  }
}

TEST(InstrumentToml, TellsWhatTheSceneStatesInWallTime) {
  Scene scene = full_scene();
  scene.told.u_linearity = 0.02;
  scene.told.exposure_offset_s = 4e-4;
  scene.told.u_dark_drift_dn_per_s = 0.5;
  scene.told.source_half_cone = degrees(3.0);

  const auto read = daemon::parse_instrument(instrument_toml(scene, {}), "instrument.toml");

  ASSERT_TRUE(read.has_value()) << describe(read.error());
  EXPECT_DOUBLE_EQ(read->model.detector.u_linearity, 0.02);
  EXPECT_NEAR(read->model.detector.exposure_offset_s.value, 4e-4 / 40.0, 1e-15);
  EXPECT_DOUBLE_EQ(read->model.detector.u_dark_drift_dn_per_s, 0.5 * 40.0);
  EXPECT_NEAR(in_degrees(read->cones.source_half), 3.0, 1e-9);
}

TEST(InstrumentToml, NamesTheSerialLineWhenTheStageIsOnOne) {
  const std::string text = instrument_toml(full_scene(), {.stage_line = "/run/sim/stage.tty", .stage_baud = 38400});

  const auto read = daemon::parse_instrument(text, "instrument.toml");

  ASSERT_TRUE(read.has_value()) << describe(read.error());
  ASSERT_TRUE(read->stage_address.serial.has_value());
  EXPECT_EQ(read->stage_address.serial->device, "/run/sim/stage.tty");
  EXPECT_EQ(read->stage_address.serial->baud, 38400);
}

TEST(InstrumentToml, NamesExposuresThatTheCameraTakes) {
  Bench bench(full_scene());
  const auto read = daemon::parse_instrument(instrument_toml(full_scene(), {}), "instrument.toml");
  ASSERT_TRUE(read.has_value());

  for (Duration rung = read->detector.shortest_exposure; rung <= read->detector.longest_exposure; rung *= 2) {
    EXPECT_TRUE(bench.camera.set_exposure(rung).has_value()) << rung.count();
  }
  EXPECT_TRUE(bench.camera.set_exposure(read->detector.longest_exposure).has_value());
}

TEST(ReferenceToml, IsReadByTheDaemonAsTheUndrawnStandard) {
  const Scene scene = full_scene();

  const auto read = calibration::ReferenceStandard::parse(reference_toml(scene.reference), "reference.toml");

  ASSERT_TRUE(read.has_value()) << describe(read.error());
  EXPECT_EQ(read->serial(), "SRT-99-020");
  ASSERT_EQ(read->modes().size(), 2U);
  EXPECT_DOUBLE_EQ(read->certificate().entries.front().u, 0.0025);
  const Geometry node{degrees(45.0), degrees(0.0), degrees(30.0), degrees(90.0)};
  ASSERT_EQ(read->shapes().size(), 1U);
  EXPECT_NEAR(read->shapes().front().table.value(node), SpectralonShape()(node), 5e-6) << "five digits are written";
}

Scene scene_with_meters() {
  Scene scene = full_scene();
  RadiometerSpec detector = quiet_radiometer();
  detector.serial = "PM-1";
  detector.u_range = 0.001;
  for (RadiometerRange& range : detector.ranges) range.noise = 1e-4;
  RadiometerSpec monitor = quiet_radiometer();
  monitor.serial = "PM-2";
  monitor.place = RadiometerPlace::Monitor;
  scene.radiometers = {detector, monitor};
  return scene;
}

TEST(InstrumentToml, DescribesRadiometersInBothPlaces) {
  const auto read = daemon::parse_instrument(instrument_toml(scene_with_meters(), {}), "instrument.toml");

  ASSERT_TRUE(read.has_value()) << describe(read.error());
  ASSERT_TRUE(read->detector.power && read->monitor);
  EXPECT_EQ(read->detector.power->meter.serial, "PM-1");
  EXPECT_EQ(read->detector.power->ranges_w, (std::vector{1e-2, 1e-3, 1e-4, 1e-5, 1e-6})) << "the largest first";
  EXPECT_NEAR(in_seconds(read->detector.power->reading_time()), 0.03 / 40.0, 1e-8);
  EXPECT_TRUE(read->detector.power->zero);
  EXPECT_FALSE(read->has_gate());
  ASSERT_TRUE(read->model.detector.power);
  EXPECT_EQ(read->model.detector.power->noise, 1e-4);
  EXPECT_EQ(read->model.detector.power->u_range, 0.001);
  EXPECT_EQ(read->monitor->meter.serial, "PM-2");
  EXPECT_EQ(read->monitor->range_w, 1e-2) << "1 mW and room for its drift";
  EXPECT_DOUBLE_EQ(read->lamp.high, 5e-3) << "in the monitor's unit";
}

TEST(InstrumentToml, LeavesTheCameraItsGateBesideARadiometerInTheLampsLight) {
  Scene scene = scene_with_meters();
  scene.radiometers.erase(scene.radiometers.begin());

  const auto read = daemon::parse_instrument(instrument_toml(scene, {}), "instrument.toml");

  ASSERT_TRUE(read.has_value()) << describe(read.error());
  EXPECT_TRUE(read->has_gate());
  EXPECT_FALSE(read->detector.power);
  EXPECT_TRUE(read->monitor);
}

TEST(InstrumentToml, IsRefusedWhenARadiometerHasNoMonitorBesideIt) {
  Scene scene = scene_with_meters();
  scene.radiometers.pop_back();

  const auto read = daemon::parse_instrument(instrument_toml(scene, {}), "instrument.toml");

  ASSERT_FALSE(read.has_value());
  EXPECT_NE(describe(read.error()).find("[monitor]"), std::string::npos) << describe(read.error());
}

TEST(InstrumentToml, IsRefusedWhenBothPlacesNameOneMeter) {
  Scene scene = scene_with_meters();
  scene.radiometers[1].serial = scene.radiometers[0].serial;

  const auto read = daemon::parse_instrument(instrument_toml(scene, {}), "instrument.toml");

  ASSERT_FALSE(read.has_value());
  EXPECT_NE(describe(read.error()).find("is the detector's"), std::string::npos) << describe(read.error());
}

}  // namespace
}  // namespace gonio::sim::test
