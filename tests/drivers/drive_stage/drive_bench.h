#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "base/clock.h"
#include "drivers/drive_stage/drive_halt_line.h"
#include "drivers/drive_stage/drive_stage.h"
#include "drivers/motion/homing_task.h"
#include "drivers/motion/move_task.h"
#include "sim/scene/drive_stage.h"
#include "tests/sim/bench.h"
#include "tests/support/in_process_unit_link.h"

namespace gonio::drivers::test {

using gonio::test::InProcessUnitLink;
using stage::Axis;

/// Six simulated drives and a coupler in a time that the test moves, with the driver and the halt line over links of
/// their own.
class DriveBench {
 public:
  explicit DriveBench(sim::Scene scene = scene_with_drives())
      : config(config_of(scene)),
        instrument(std::move(scene), {}, clock),
        driver(links(motion), config, latch, clock),
        line(links(halts), links(beats), config, latch, clock) {}

  static sim::Scene scene_with_drives() {
    sim::Scene scene = sim::test::quiet_scene();
    scene.stage.drives = sim::drive_stage_of(scene.stage);
    return scene;
  }

  static StageConfig config_of(const sim::Scene& scene) {
    StageConfig config;
    config.drives = scene.stage.drives;
    config.has_gate = false;
    config.registers.axis_scale = scene.stage.registers.axis_scale;
    for (const Axis a : stage::kAllAxes) {
      const sim::AxisSpec& spec = scene.stage.axes[stage::index_of(a)];
      config.axes[stage::index_of(a)] = {.offset = 0.0,
                                         .low = spec.low,
                                         .high = spec.high,
                                         .speed = spec.speed,
                                         .acceleration = spec.acceleration,
                                         .settle = seconds(spec.settle_s),
                                         .window = spec.window};
    }
    config.reply_timeout = std::chrono::milliseconds(250);
    config.homing_time = std::chrono::seconds(120);
    config.shutter_time = std::chrono::seconds(2);
    config.heartbeat_timeout = std::chrono::seconds(2);
    config.deadline_margin = std::chrono::seconds(1);
    return config;
  }

  StageState look() {
    Result<StageState> state = driver.read_state();
    EXPECT_TRUE(state) << describe(state.error());
    return state.value_or(StageState{});
  }
  /// Lets time pass in steps, the drives' watchdogs being fed as they would be.
  void wait(Duration time) {
    const Instant end = clock.now() + time;
    while (clock.now() < end) {
      clock.advance(std::min<Duration>(std::chrono::milliseconds(100), end - clock.now()));
      if (feeds) (void)line.beat();
    }
  }
  /// Shows the task one look after the other until it is done or fails.
  template <class Task>
  Result<void> play(Task task) {
    for (int looks = 0; looks < 20000; ++looks) {
      const Result<StageState> seen = driver.read_state();
      if (!seen) return failure(seen.error());
      const Result<MotionProgress> progress = task.look(*seen, seen->at);
      if (!progress) return failure(progress.error());
      if (progress->is_done) return {};
      wait(progress->next_look - clock.now());
    }
    ADD_FAILURE() << "never done";
    return {};
  }
  Result<void> home(Epoch epoch = 0) {
    const StageState before = look();
    const Result<MotionToken> token = driver.start_homing(epoch);
    if (!token) return failure(token.error());
    return play(HomingTask(config, before, *token, epoch, before.at));
  }
  Result<void> move(const MotionTarget& target, Epoch epoch = 0) {
    const StageState before = look();
    const Result<MotionToken> token = driver.start_move(target, epoch);
    if (!token) return failure(token.error());
    return play(MoveTask(config, before, target, *token, epoch, before.at));
  }
  static MotionTarget to(Axis axis, double position) {
    MotionTarget target;
    target[stage::index_of(axis)] = position;
    return target;
  }
  template <class F>
  auto truth(F f) {
    return instrument.with([&](sim::LiveInstrument::Parts& parts) { return f(parts.instrument.stage(), parts.now); });
  }
  double position(Axis axis) {
    return truth([&](sim::StageModel& stage, Instant now) { return stage.axis(axis).position(now); });
  }
  bool is_moving() {
    return truth([](sim::StageModel& stage, Instant now) { return stage.is_moving(now); });
  }
  /// The links of one kind; the coupler's is the last.
  struct Wires {
    std::vector<std::unique_ptr<InProcessUnitLink>> all;
    InProcessUnitLink& of(Axis axis) { return *all[stage::index_of(axis)]; }
    InProcessUnitLink& io() { return *all.back(); }
  };

  ManualClock clock;
  StageConfig config;
  sim::LiveInstrument instrument;
  Wires motion;
  Wires halts;
  Wires beats;
  DriveLatch latch;
  bool feeds = true;
  DriveStage driver;
  DriveHaltLine line;

 private:
  DriveLinks links(Wires& wires) {
    DriveLinks made;
    for (const Axis axis : stage::kAllAxes) {
      wires.all.push_back(std::make_unique<InProcessUnitLink>(instrument, config.drives->axis(axis).unit_id));
      made.axes[stage::index_of(axis)] = wires.all.back().get();
    }
    wires.all.push_back(std::make_unique<InProcessUnitLink>(instrument, config.drives->io->unit_id));
    made.io = wires.all.back().get();
    return made;
  }
};

}  // namespace gonio::drivers::test
