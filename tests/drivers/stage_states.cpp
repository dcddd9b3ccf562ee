#include "tests/drivers/stage_states.h"

namespace gonio::drivers::test {

using namespace std::chrono_literals;

StageConfig simple_config() {
  StageConfig config;
  config.registers = stage::own_register_map();
  for (AxisConfig& axis : config.axes) {
    axis = {
        .offset = 0.0, .low = 0.0, .high = 90.0, .speed = 10.0, .acceleration = 20.0, .settle = 100ms, .window = 0.01};
  }
  config.reply_timeout = 250ms;
  config.homing_time = 30s;
  config.shutter_time = 2s;
  config.heartbeat_timeout = 2s;
  config.deadline_factor = 1.5;
  config.deadline_margin = 1s;
  return config;
}

StageState resting_state() {
  StageState state;
  state.boot_counter = 7;
  state.homed = true;
  state.epoch = 5;
  state.stop_count = 3;
  state.accepted_token = 100;
  state.refused_token = 101;
  for (AxisState& axis : state.axes) axis.homed = true;
  return state;
}

}  // namespace gonio::drivers::test
