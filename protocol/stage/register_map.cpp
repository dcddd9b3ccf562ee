#include "protocol/stage/register_map.h"

#include <algorithm>
#include <initializer_list>

namespace gonio::stage {
namespace {

constexpr std::array<std::string_view, kFieldCount> kFieldNames{
    "token",
    "identity",
    "map_version",
    "boot_counter",
    "status",
    "fault",
    "epoch",
    "stop_count",
    "accepted_token",
    "refused_token",
    "refusal",
    "heartbeat_seen",
    "heartbeat_timeout_ms",
    "source_shutter",
    "detector_shutter",
    "monitor",
    "lamp_temperature",
    "detector_temperature",
    "room_temperature",
    "humidity",
    "gate_count",
    "gate_state",
    "gate_monitor_mean",
    "gate_monitor_se",
    "gate_monitor_samples",
    "heartbeat",
    "halt_epoch",
    "halt_key",
    "reset_epoch",
    "reset_key",
    "source_shutter_command",
    "detector_shutter_command",
    "motion_epoch",
    "motion_token",
    "motion_mask",
    "motion_command",
};

constexpr std::array<std::string_view, kAxisFieldCount> kAxisFieldNames{
    "encoder", "status", "fault", "gate_open_encoder", "gate_close_encoder", "target"};

constexpr std::array<std::string_view, 10> kRefusalNames{
    "none",           "epoch too old", "halted",         "heartbeat tripped", "not homed",
    "beyond a limit", "stage fault",   "interlock open", "already moving",    "bad command"};

// The smallest run that holds all registers it was shown.
class Run {
 public:
  void add(const Register& reg) {
    first_ = std::min<unsigned>(first_, reg.address);
    end_ = std::max<unsigned>(end_, reg.address + unsigned{reg.words});
  }
  [[nodiscard]] Block block() const {
    return {static_cast<std::uint16_t>(first_), static_cast<std::uint16_t>(end_ - first_)};
  }

 private:
  unsigned first_ = 0xFFFF;
  unsigned end_ = 0;
};

Block run_of(const RegisterMap& map, std::initializer_list<Field> fields) {
  Run run;
  for (const Field field : fields) run.add(map.at(field));
  return run.block();
}

// Gives out registers one after the other.
class Layout {
 public:
  explicit Layout(unsigned first) : next_(first) {}
  Register unsigned_value(unsigned words = 1) { return take(words, false); }
  Register signed_value(unsigned words = 1) { return take(words, true); }

 private:
  Register take(unsigned words, bool is_signed) {
    const Register reg{static_cast<std::uint16_t>(next_), static_cast<std::uint8_t>(words), is_signed, false};
    next_ += words;
    return reg;
  }
  unsigned next_;
};

Register& slot(RegisterMap& map, Field field) {
  return map.fields[static_cast<std::size_t>(field)];
}
Register& slot(RegisterMap& map, Axis axis, AxisField field) {
  return map.axes[index_of(axis)][static_cast<std::size_t>(field)];
}

bool is_two_words(Field field) {
  switch (field) {
    case Field::BootCounter:
    case Field::Epoch:
    case Field::Monitor:
    case Field::GateCount:
    case Field::GateMonitorMean:
    case Field::GateMonitorSe:
    case Field::GateMonitorSamples:
      return true;
    default:
      return false;
  }
}

bool is_temperature(Field field) {
  return field == Field::LampTemperature || field == Field::DetectorTemperature || field == Field::RoomTemperature;
}

void lay_out_status(RegisterMap& map) {
  Layout status(0);
  for (std::size_t i = 0; i <= static_cast<std::size_t>(Field::GateMonitorSamples); ++i) {
    const auto field = static_cast<Field>(i);
    const unsigned words = is_two_words(field) ? 2 : 1;
    slot(map, field) = is_temperature(field) ? status.signed_value(words) : status.unsigned_value(words);
  }
  for (const Axis axis : kAllAxes) {
    slot(map, axis, AxisField::Encoder) = status.signed_value(2);
    slot(map, axis, AxisField::Status) = status.unsigned_value();
    slot(map, axis, AxisField::Fault) = status.unsigned_value();
    slot(map, axis, AxisField::GateOpenEncoder) = status.signed_value(2);
    slot(map, axis, AxisField::GateCloseEncoder) = status.signed_value(2);
  }
}

// Each group of commands starts at a round address, so that a wrong map shows as an illegal address, not as a motion.
void lay_out_commands(RegisterMap& map) {
  Layout motion(128);
  slot(map, Field::MotionEpoch) = motion.unsigned_value(2);
  slot(map, Field::MotionToken) = motion.unsigned_value();
  slot(map, Field::MotionMask) = motion.unsigned_value();
  for (const Axis axis : kAllAxes) slot(map, axis, AxisField::Target) = motion.signed_value(2);
  slot(map, Field::MotionCommand) = motion.unsigned_value();
  Layout halt(160);
  slot(map, Field::HaltEpoch) = halt.unsigned_value(2);
  slot(map, Field::HaltKey) = halt.unsigned_value();
  Layout reset(176);
  slot(map, Field::ResetEpoch) = reset.unsigned_value(2);
  slot(map, Field::ResetKey) = reset.unsigned_value();
  Layout shutters(192);
  slot(map, Field::SourceShutterCommand) = shutters.unsigned_value();
  slot(map, Field::DetectorShutterCommand) = shutters.unsigned_value();
  slot(map, Field::Heartbeat) = Layout(208).unsigned_value();
}

}  // namespace

Block RegisterMap::status_block() const {
  Run run;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(Field::GateMonitorSamples); ++i) run.add(fields[i]);
  for (const auto& axis : axes) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(AxisField::Target); ++i) run.add(axis[i]);
  }
  return run.block();
}

Block RegisterMap::motion_block() const {
  Run run;
  for (const Field f : {Field::MotionEpoch, Field::MotionToken, Field::MotionMask, Field::MotionCommand})
    run.add(at(f));
  for (const Axis axis : kAllAxes) run.add(at(axis, AxisField::Target));
  return run.block();
}

Block RegisterMap::halt_block() const {
  return run_of(*this, {Field::HaltEpoch, Field::HaltKey});
}
Block RegisterMap::reset_block() const {
  return run_of(*this, {Field::ResetEpoch, Field::ResetKey});
}
Block RegisterMap::shutter_block() const {
  return run_of(*this, {Field::SourceShutterCommand, Field::DetectorShutterCommand});
}

std::string_view refusal_name(Refusal refusal) {
  return kRefusalNames[static_cast<std::size_t>(refusal)];
}
std::string_view field_name(Field field) {
  return kFieldNames[static_cast<std::size_t>(field)];
}
std::string_view field_name(AxisField field) {
  return kAxisFieldNames[static_cast<std::size_t>(field)];
}

RegisterMap own_register_map() {
  RegisterMap map;
  lay_out_status(map);
  lay_out_commands(map);
  constexpr double kDegreesPerCount = 1e-4;
  constexpr double kMillimetresPerCount = 1e-3;
  constexpr double kSlotsPerCount = 1e-3;
  map.axis_scale = {kDegreesPerCount, kDegreesPerCount,     kDegreesPerCount,
                    kDegreesPerCount, kMillimetresPerCount, kSlotsPerCount};
  map.monitor_scale = 1e-7;  // a full scale of 429, and steps far below the noise of a lamp near 1
  return map;
}

}  // namespace gonio::stage
