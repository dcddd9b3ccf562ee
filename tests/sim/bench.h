#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "protocol/stage/register_map.h"
#include "reflectance/surface/make_surface.h"
#include "sim/devices/camera_model.h"
#include "sim/devices/instrument.h"
#include "sim/devices/stage_face.h"
#include "sim/scene/scene.h"

namespace gonio::sim::test {

using stage::Axis;
using stage::AxisField;
using stage::Field;

/// A bench without noise, errors or drift, at real time: tests switch on what they look at.
inline Scene quiet_scene() {
  Scene scene;
  scene.name = "test";
  scene.draws_errors = false;
  scene.sample.push_back({.surface = *reflectance::make_surface("lambertian", {{"rho", 0.5}}), .weight = 1.0});
  scene.reference.certificate.push_back({.wavelength = nanometres(568.0), .reflectance = 0.99, .uncertainty = 0.005});
  scene.detector.electrons_per_s = 700000.0;
  scene.detector.offset_dn = 64.0;
  scene.stage.registers = stage::own_register_map();
  const AxisSpec arm{.low = 0.0, .high = 85.0, .speed = 20.0, .acceleration = 40.0, .settle_s = 0.1, .window = 0.01};
  const AxisSpec azimuth{
      .low = -185.0, .high = 365.0, .speed = 40.0, .acceleration = 80.0, .settle_s = 0.1, .window = 0.01};
  scene.stage.axes = {arm,
                      arm,
                      azimuth,
                      azimuth,
                      AxisSpec{.low = 0.0, .high = 250.0, .speed = 100.0, .acceleration = 200.0, .window = 0.05},
                      AxisSpec{.low = 1.0, .high = 4.0, .speed = 2.0, .acceleration = 8.0, .window = 0.01}};
  scene.filters.push_back({.slot = 1, .centroid = nanometres(568.0), .fwhm = nanometres(10.0)});
  return scene;
}

inline constexpr Instant kPowerUp{std::chrono::seconds(1000)};

/// A stage seen through its registers, and a camera, in a time that the test moves.
class Bench {
 public:
  explicit Bench(Scene scene = quiet_scene(), InstrumentMemory memory = {})
      : instrument(std::move(scene), std::move(memory), kPowerUp), face(instrument), camera(instrument) {}

  void wait(double seconds_of_wall) { now += seconds(seconds_of_wall); }

  std::int64_t value(const stage::Register& reg) {
    std::vector<std::uint16_t> words(reg.words);
    const auto refused = face.read(reg.address, words, now);
    return refused ? -1 : stage::decode(words, reg.address, reg);
  }
  std::int64_t value(Field field) { return value(map().at(field)); }
  double position(Axis axis) {
    return static_cast<double>(value(map().at(axis, AxisField::Encoder))) * map().axis_scale[stage::index_of(axis)];
  }
  bool has(stage::StatusBit bit) { return (value(Field::Status) & stage::bit(bit)) != 0; }
  stage::Refusal refusal() { return static_cast<stage::Refusal>(value(Field::Refusal)); }

  /// The motion block of one axis.
  void command(std::uint16_t what, std::uint32_t epoch, Axis axis = Axis::ThetaI, double target = 0.0) {
    const stage::Block block = map().motion_block();
    std::vector<std::uint16_t> words(block.count, 0);
    const auto put = [&](const stage::Register& reg, std::int64_t v) { stage::encode(words, block.first, reg, v); };
    put(map().at(Field::MotionEpoch), epoch);
    put(map().at(Field::MotionToken), ++token);
    put(map().at(Field::MotionMask), 1 << stage::index_of(axis));
    put(map().at(axis, AxisField::Target), std::llround(target / map().axis_scale[stage::index_of(axis)]));
    put(map().at(Field::MotionCommand), what);
    last_write = face.write(block.first, words, now);
  }
  void move(Axis axis, double target, std::uint32_t epoch = 0) { command(stage::kCommandMove, epoch, axis, target); }
  /// Homes all axes and waits until they are.
  void home() {
    command(stage::kCommandHome, 0);
    wait(60.0);
  }
  void write(Field field, std::uint16_t word) {
    last_write = face.write(map().at(field).address, std::vector{word}, now);
  }
  void keyed(stage::Block block, Field epoch_field, std::uint32_t epoch, Field key_field, std::uint16_t key) {
    std::vector<std::uint16_t> words(block.count, 0);
    stage::encode(words, block.first, map().at(epoch_field), epoch);
    stage::encode(words, block.first, map().at(key_field), key);
    last_write = face.write(block.first, words, now);
  }
  void halt(std::uint32_t epoch) {
    keyed(map().halt_block(), Field::HaltEpoch, epoch, Field::HaltKey, stage::kHaltKey);
  }
  void reset(std::uint32_t epoch) {
    keyed(map().reset_block(), Field::ResetEpoch, epoch, Field::ResetKey, stage::kResetKey);
  }
  void open_shutters() {
    write(Field::SourceShutterCommand, 1);
    write(Field::DetectorShutterCommand, 1);
  }
  /// One exposure from trigger to end.
  Exposure expose(double wall_s) {
    EXPECT_TRUE(camera.set_exposure(seconds(wall_s)).has_value());
    EXPECT_TRUE(camera.trigger(now));
    wait(wall_s);
    const auto exposure = camera.collect_exposure(now);
    EXPECT_TRUE(exposure.has_value());
    return exposure.value_or(Exposure{});
  }

  const stage::RegisterMap& map() { return face.map(); }

  Instant now = kPowerUp;
  Instrument instrument;
  StageFace face;
  CameraModel camera;
  std::uint16_t token = 0;
  std::optional<ModbusException> last_write;
};

}  // namespace gonio::sim::test
