#include "drivers/modbus_stage/stage_state_words.h"

#include <fmt/format.h>

namespace gonio::drivers {
namespace {

using stage::AxisField;
using stage::Field;

// The status block with the map that tells where each value stands in it.
struct Words {
  std::span<const std::uint16_t> block;
  const stage::RegisterMap& map;
  std::uint16_t first;

  [[nodiscard]] std::int64_t at(Field field) const { return stage::decode(block, first, map.at(field)); }
  [[nodiscard]] std::int64_t at(stage::Axis axis, AxisField field) const {
    return stage::decode(block, first, map.at(axis, field));
  }
  template <class T>
  [[nodiscard]] T as(Field field) const {
    return static_cast<T>(at(field));
  }
  [[nodiscard]] bool has(stage::StatusBit flag) const { return (at(Field::Status) & stage::bit(flag)) != 0; }
};

Error reply_error(ErrorCode code, Field field, std::int64_t seen, std::string limit) {
  return {.code = code,
          .device = "stage",
          .tried = "read its state",
          .seen = fmt::format("{} {}", stage::field_name(field), seen),
          .limit = std::move(limit)};
}

Result<void> check_identity(const Words& words) {
  if (const auto identity = words.at(Field::Identity); identity != stage::kIdentity) {
    return failure(reply_error(ErrorCode::WrongDevice, Field::Identity, identity, fmt::format("{}", stage::kIdentity)));
  }
  if (const auto version = words.at(Field::MapVersion); version != stage::kMapVersion) {
    return failure(
        reply_error(ErrorCode::WrongDevice, Field::MapVersion, version, fmt::format("{}", stage::kMapVersion)));
  }
  return {};
}

Result<void> check_choices(const Words& words) {
  constexpr auto kLastRefusal = static_cast<std::int64_t>(stage::Refusal::BadCommand);
  constexpr auto kLastShutter = static_cast<std::int64_t>(stage::ShutterState::Moving);
  for (const auto& [field, last] : {std::pair{Field::Refusal, kLastRefusal},
                                    {Field::SourceShutter, kLastShutter},
                                    {Field::DetectorShutter, kLastShutter}}) {
    const std::int64_t seen = words.at(field);
    if (seen < 0 || seen > last)
      return failure(reply_error(ErrorCode::BadReply, field, seen, fmt::format("0 to {}", last)));
  }
  return {};
}

AxisState axis_state(const Words& words, const StageConfig& config, stage::Axis axis) {
  const std::int64_t status = words.at(axis, AxisField::Status);
  const auto has = [status](stage::AxisBit flag) { return (status & stage::bit(flag)) != 0; };
  AxisState state;
  state.counts = static_cast<std::int32_t>(words.at(axis, AxisField::Encoder));
  state.position = position_of(config, axis, state.counts);
  state.moving = has(stage::AxisBit::Moving);
  state.homed = has(stage::AxisBit::Homed);
  state.at_limit = has(stage::AxisBit::AtLowLimit) || has(stage::AxisBit::AtHighLimit);
  state.fault = static_cast<std::uint16_t>(words.at(axis, AxisField::Fault));
  return state;
}

GateRecord gate_record(const Words& words) {
  GateRecord gate;
  gate.count = words.as<std::uint32_t>(Field::GateCount);
  gate.open = words.at(Field::GateState) != 0;
  for (const stage::Axis axis : stage::kAllAxes) {
    const std::size_t i = stage::index_of(axis);
    gate.open_counts[i] = static_cast<std::int32_t>(words.at(axis, AxisField::GateOpenEncoder));
    gate.close_counts[i] = static_cast<std::int32_t>(words.at(axis, AxisField::GateCloseEncoder));
  }
  gate.monitor_mean = words.as<double>(Field::GateMonitorMean) * words.map.monitor_scale;
  gate.monitor_se = words.as<double>(Field::GateMonitorSe) * words.map.monitor_scale;
  gate.monitor_samples = words.as<std::uint32_t>(Field::GateMonitorSamples);
  return gate;
}

void read_sensors(const Words& words, StageState& state) {
  const auto temperature = [&](Field field) { return words.as<double>(field) * words.map.temperature_scale_c; };
  state.monitor = words.as<double>(Field::Monitor) * words.map.monitor_scale;
  state.lamp_temperature_c = temperature(Field::LampTemperature);
  state.detector_temperature_c = temperature(Field::DetectorTemperature);
  state.room_temperature_c = temperature(Field::RoomTemperature);
  state.humidity_percent = words.as<double>(Field::Humidity) * words.map.humidity_scale_percent;
}

}  // namespace

Result<StageState> stage_state_of(std::span<const std::uint16_t> block, const StageConfig& config) {
  const Words words{block, config.registers, config.registers.status_block().first};
  GONIO_TRY(check_identity(words));
  GONIO_TRY(check_choices(words));
  StageState state;
  state.boot_counter = words.as<std::uint32_t>(Field::BootCounter);
  state.moving = words.has(stage::StatusBit::Moving);
  state.homed = words.has(stage::StatusBit::Homed);
  state.halted = words.has(stage::StatusBit::Halted);
  state.heartbeat_tripped = words.has(stage::StatusBit::HeartbeatTripped);
  state.interlock_open = words.has(stage::StatusBit::InterlockOpen);
  state.fault = words.as<std::uint16_t>(Field::Fault);
  state.epoch = words.as<Epoch>(Field::Epoch);
  state.stop_count = words.as<std::uint16_t>(Field::StopCount);
  state.accepted_token = words.as<MotionToken>(Field::AcceptedToken);
  state.refused_token = words.as<MotionToken>(Field::RefusedToken);
  state.refusal = words.as<stage::Refusal>(Field::Refusal);
  for (const stage::Axis axis : stage::kAllAxes) {
    state.axes[stage::index_of(axis)] = axis_state(words, config, axis);
  }
  state.source_shutter = words.as<stage::ShutterState>(Field::SourceShutter);
  state.detector_shutter = words.as<stage::ShutterState>(Field::DetectorShutter);
  read_sensors(words, state);
  state.gate = gate_record(words);
  return state;
}

}  // namespace gonio::drivers
