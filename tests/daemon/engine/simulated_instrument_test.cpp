// The actors and drivers on the simulated stage and camera, without a wire, in the simulator's own time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/config/instrument.h"
#include "daemon/engine/detector_actor.h"
#include "daemon/engine/stage_actor.h"
#include "drivers/genicam_camera/genicam_camera.h"
#include "drivers/modbus_stage/modbus_halt_line.h"
#include "drivers/modbus_stage/modbus_stage.h"
#include "sim/scene/papers.h"
#include "sim/scene/read_scene.h"
#include "sim/wires/live_instrument.h"
#include "tests/support/discrete_executor.h"
#include "tests/support/in_process_camera_link.h"
#include "tests/support/in_process_modbus_link.h"

namespace gonio::daemon {
namespace {

using namespace std::chrono_literals;
using stage::Axis;
using test::DiscreteExecutor;

sim::Scene lambertian() {
  auto scene = sim::read_scene(GONIO_SCENE_DIR "/lambertian.toml");
  EXPECT_TRUE(scene) << describe(scene.error());
  return std::move(*scene);
}

Instrument instrument_of(const sim::Scene& scene) {
  auto instrument = parse_instrument(sim::instrument_toml(scene, {}), "instrument.toml");
  EXPECT_TRUE(instrument) << describe(instrument.error());
  return std::move(*instrument);
}

class SimulatedInstrument : public testing::Test {
 protected:
  SimulatedInstrument() {
    executor.add("stage", [this](Instant now) { return stage_actor.step(now); });
    executor.add("camera", [this](Instant now) { return detector_actor.step(now); });
  }

  static drivers::GenicamCameraConfig camera_config(const DetectorConfig& detector) {
    return {.serial = detector.serial,
            .format = {.width = detector.width_px,
                       .height = detector.height_px,
                       .pixel_format = detector.pixel_format,
                       .packet_size_bytes = detector.packet_size_bytes},
            .settings = {.exposure = detector.shortest_exposure, .gain_db = detector.gain_db}};
  }

  void ask(StageRequest request) {
    executor.post([this, request](Instant now) { stage_actor.on(request, now); });
  }
  void ask(DetectorRequest request) {
    executor.post([this, request](Instant now) { detector_actor.on(request, now); });
  }
  void run_for_answers(std::size_t of_stage, std::size_t of_detector) {
    const auto are_there = [&] { return stage_answers.size() >= of_stage && detector_answers.size() >= of_detector; };
    ASSERT_EQ(executor.run_until(are_there, 1h), DiscreteExecutor::Outcome::Reached) << executor.describe();
  }
  void expect_stage_failure(ErrorCode code) {
    ASSERT_FALSE(stage_answers.empty());
    ASSERT_FALSE(stage_answers.back().state.has_value());
    EXPECT_EQ(stage_answers.back().state.error().code, code) << describe(stage_answers.back().state.error());
  }
  void home() {
    ask(Home{1, epoch});
    run_for_answers(1, 0);
    ASSERT_TRUE(stage_answers[0].state) << describe(stage_answers[0].state.error());
    stage_answers.clear();
  }

  MoveTo to_sample(Ticket ticket) {
    MoveTo move{
        .ticket = ticket, .epoch = epoch, .target = {}, .source_shutter_open = true, .detector_shutter_open = true};
    move.target[stage::index_of(Axis::ThetaI)] = 30.0;
    move.target[stage::index_of(Axis::ThetaR)] = 45.0;
    move.target[stage::index_of(Axis::PhiR)] = 90.0;
    move.target[stage::index_of(Axis::Carriage)] = in_millimetres(instrument.carriage.sample);
    return move;
  }

  ManualClock clock;
  sim::LiveInstrument simulated{lambertian(), {}, clock};
  Instrument instrument = instrument_of(simulated.scene());
  drivers::Epoch epoch = 1;
  test::InProcessModbusLink stage_link{simulated};
  test::InProcessModbusLink halt_link{simulated};
  test::InProcessCameraLink camera_link{simulated};
  drivers::ModbusStage stage{stage_link, instrument.stage, clock};
  drivers::ModbusHaltLine halt_line{halt_link, instrument.stage.registers};
  drivers::GenicamCamera camera{camera_link, camera_config(instrument.detector), clock};
  std::vector<StageAnswer> stage_answers;
  std::vector<DetectorActor::Answer> detector_answers;
  StageActor stage_actor{stage, instrument.stage, [this](StageAnswer a) { stage_answers.push_back(std::move(a)); }};
  DetectorActor detector_actor{camera,
                               {instrument.detector.aperture, nullptr, instrument.model.detector},
                               [this](DetectorActor::Answer a) { detector_answers.push_back(std::move(a)); }};
  DiscreteExecutor executor{clock};
};

TEST_F(SimulatedInstrument, RefusesToMoveBeforeItIsHomed) {
  ask(to_sample(1));
  run_for_answers(1, 0);

  expect_stage_failure(ErrorCode::NotHomed);
}

TEST_F(SimulatedInstrument, MovesWhereItWasTold) {
  home();

  ask(to_sample(2));
  run_for_answers(1, 0);

  ASSERT_TRUE(stage_answers[0].state) << describe(stage_answers[0].state.error());
  const drivers::StageState& state = *stage_answers[0].state;
  EXPECT_NEAR(state.axes[stage::index_of(Axis::ThetaR)].position, 45.0, 0.01);
  EXPECT_NEAR(state.axes[stage::index_of(Axis::PhiR)].position, 90.0, 0.01);
  EXPECT_EQ(state.source_shutter, stage::ShutterState::Open);
}

TEST_F(SimulatedInstrument, TakesAFrameWithEncodersAndMonitorOfExactlyItsExposure) {
  home();
  ask(to_sample(2));
  run_for_answers(1, 0);
  ASSERT_TRUE(stage_answers[0].state) << describe(stage_answers[0].state.error());
  const std::uint32_t before = stage_answers[0].state->gate.count;
  const Duration exposure = instrument.detector.shortest_exposure * 8;

  ask(WatchGate{.ticket = 3, .after = before, .expected = exposure, .held = to_sample(0).target});
  ask(TakeFrame{4, {exposure, 0.0}});
  run_for_answers(2, 1);

  ASSERT_TRUE(stage_answers[1].state) << describe(stage_answers[1].state.error());
  const auto& frame = std::get<FrameAnswer>(detector_answers[0]).frame;
  ASSERT_TRUE(frame) << describe(frame.error());
  EXPECT_EQ(stage_answers[1].state->gate.count, before + 1);
  EXPECT_GT(stage_answers[1].state->gate.monitor_mean, instrument.lamp.low);
  EXPECT_GT(frame->region.mean, simulated.scene().detector.offset_dn);
  EXPECT_EQ(frame->settings.exposure, exposure);
}

TEST_F(SimulatedInstrument, SeesThatAHaltEndedItsMoveAndMovesAgainAfterAReset) {
  home();
  ask(to_sample(2));
  executor.run_for(1ms);

  ASSERT_TRUE(halt_line.halt(2));
  run_for_answers(1, 0);
  expect_stage_failure(ErrorCode::Stopped);
  epoch = 2;
  ask(ResetStage{3, epoch});
  ask(to_sample(4));
  run_for_answers(3, 0);

  EXPECT_TRUE(stage_answers[2].state) << describe(stage_answers[2].state.error());
}

TEST_F(SimulatedInstrument, RefusesAMoveOfAnOldEpochAfterAHalt) {
  home();
  ASSERT_TRUE(halt_line.halt(7));
  ask(ResetStage{2, 7});
  ask(to_sample(3));  // still of epoch 1

  run_for_answers(2, 0);

  expect_stage_failure(ErrorCode::StaleEpoch);
}

TEST_F(SimulatedInstrument, StopsByItselfWhenTheHeartbeatIsMissed) {
  home();
  ASSERT_TRUE(halt_line.watch_heartbeat(20ms));
  ASSERT_TRUE(halt_line.beat());
  ask(to_sample(2));

  run_for_answers(1, 0);

  expect_stage_failure(ErrorCode::HeartbeatTripped);
}

TEST_F(SimulatedInstrument, HasLostItsPositionAfterAPowerCycleInAMove) {
  home();
  ask(to_sample(2));
  executor.run_for(1ms);

  simulated.with([](auto& parts) { parts.instrument.power_cycle_stage(parts.now); });
  run_for_answers(1, 0);

  expect_stage_failure(ErrorCode::PositionLost);
}

TEST_F(SimulatedInstrument, TellsThatTheStageIsGoneAndGoesOnWhenItIsBack) {
  home();
  stage_link.set_broken(Error{.code = ErrorCode::Unreachable, .device = "stage", .tried = "talk", .seen = "no"});
  ask(to_sample(2));
  run_for_answers(1, 0);
  expect_stage_failure(ErrorCode::Unreachable);
  stage_link.set_broken(std::nullopt);

  ask(to_sample(3));
  run_for_answers(2, 0);

  EXPECT_TRUE(stage_answers[1].state.has_value());
}

TEST_F(SimulatedInstrument, WritesTheCamerasSettingsAgainWhenItIsBack) {
  const Duration exposure = instrument.detector.shortest_exposure * 4;
  ask(TakeFrame{1, {exposure, 0.0}});
  run_for_answers(0, 1);
  camera_link.set_broken(Error{.code = ErrorCode::ControlLost, .device = "detector", .tried = "talk", .seen = "no"});
  ask(TakeFrame{2, {exposure, 0.0}});
  run_for_answers(0, 2);
  camera_link.set_broken(std::nullopt);
  simulated.with([](auto& parts) { static_cast<void>(parts.camera.set_gain(12.0)); });  // as another controller left it

  ask(TakeFrame{3, {exposure, 0.0}});
  run_for_answers(0, 3);

  const auto& lost = std::get<FrameAnswer>(detector_answers[1]).frame;
  ASSERT_FALSE(lost.has_value());
  EXPECT_EQ(lost.error().code, ErrorCode::ControlLost);
  const auto& back = std::get<FrameAnswer>(detector_answers[2]).frame;
  ASSERT_TRUE(back) << describe(back.error());
  EXPECT_EQ(back->settings, (drivers::ExposureSettings{exposure, 0.0}));
}

}  // namespace
}  // namespace gonio::daemon
