#include "protocol/stage/drive_map.h"

namespace gonio::stage {
namespace {

constexpr std::array<std::string_view, kDriveVerbCount> kVerbNames{"setup", "enable", "prepare_move", "start_move",
                                                                   "home",  "halt",   "clear_stop",   "fault_reset"};
constexpr std::array<std::string_view, kDriveFlagCount> kFlagNames{"moving",  "homed",   "fault",           "enabled",
                                                                   "stopped", "tripped", "following_error", "at_limit"};
constexpr std::array<std::string_view, 6> kValueNames{"fixed",        "target",    "speed",
                                                      "acceleration", "low_limit", "high_limit"};

// Every parameter of this drive is 32 bits wide, high word first.
Register word_pair(std::uint16_t address, bool is_signed = false) {
  return {.address = address, .words = 2, .is_signed = is_signed};
}

DriveStep write(std::string reg, std::int64_t value) {
  return {.reg = std::move(reg), .value = value};
}
DriveStep write(std::string reg, DriveValue source) {
  return {.reg = std::move(reg), .source = source};
}
DriveStep unless_set(DriveStep step) {
  step.unless_set = true;
  return step;
}
DriveStep await(std::string reg, std::int64_t mask, std::int64_t value) {
  return {.kind = DriveStep::Kind::Await, .reg = std::move(reg), .value = value, .mask = mask};
}

// Words of the control word and bits of the status word (CiA 402-2, 8.4: state machine; 10.3 and 11.3: modes).
constexpr std::int64_t kShutdown = 0x06;
constexpr std::int64_t kSwitchOn = 0x07;
constexpr std::int64_t kEnableOperation = 0x0F;
constexpr std::int64_t kStart = 0x1F;  // enabled, and the edge of "new set-point" or "homing start"
constexpr std::int64_t kQuickStop = 0x02;
constexpr std::int64_t kFaultReset = 0x80;
constexpr std::int64_t kStateMask = 0x6F;
constexpr std::int64_t kOperationEnabled = 0x27;
constexpr std::int64_t kQuickStopActive = 0x07;
constexpr std::int64_t kFaultBit = 0x08;
constexpr std::int64_t kMotionEnded = 0x4000;  // x_end
constexpr std::int64_t kReferenced = 0x8000;   // ref_ok
constexpr std::int64_t kProfilePosition = 1;
constexpr std::int64_t kHoming = 6;

}  // namespace

const Register* DriveMap::find(std::string_view name) const {
  const auto found = registers.find(name);
  return found == registers.end() ? nullptr : &found->second;
}

std::string_view verb_name(DriveVerb verb) {
  return kVerbNames[static_cast<std::size_t>(verb)];
}
std::string_view flag_name(DriveFlag flag) {
  return kFlagNames[static_cast<std::size_t>(flag)];
}
std::string_view value_name(DriveValue value) {
  return kValueNames[static_cast<std::size_t>(value)];
}

DriveMap lexium32_drive_map() {
  DriveMap map;
  map.registers = {{"high_limit", word_pair(1544, true)},
                   {"low_limit", word_pair(1546, true)},
                   {"acceleration", word_pair(1556)},
                   {"deceleration", word_pair(1558)},
                   {"watchdog", word_pair(5644)},
                   {"control", word_pair(6914)},
                   {"status", word_pair(6916)},
                   {"mode", word_pair(6918)},
                   {"homing_method", word_pair(6936)},
                   {"target", word_pair(6940, true)},
                   {"speed", word_pair(6942)},
                   {"alarm", word_pair(7178)},
                   {"signals", word_pair(7184)},
                   {"position", word_pair(7706, true)}};
  const auto command = [&](DriveVerb verb) -> DriveCommand& { return map.commands[static_cast<std::size_t>(verb)]; };
  const auto flag = [&](DriveFlag f, std::string reg, std::int64_t mask, std::int64_t value) {
    map.flags[static_cast<std::size_t>(f)] = DriveCondition{std::move(reg), mask, value};
  };
  command(DriveVerb::Setup) = {write("acceleration", DriveValue::Acceleration),
                               write("deceleration", DriveValue::Acceleration),
                               write("low_limit", DriveValue::LowLimit), write("high_limit", DriveValue::HighLimit),
                               write("speed", DriveValue::Speed)};
  command(DriveVerb::Enable) = {write("control", kShutdown), write("control", kSwitchOn),
                                write("control", kEnableOperation), await("status", kStateMask, kOperationEnabled)};
  command(DriveVerb::PrepareMove) = {unless_set(write("mode", kProfilePosition)), write("control", kEnableOperation),
                                     write("target", DriveValue::Target)};
  command(DriveVerb::StartMove) = {write("control", kStart)};
  DriveStep begun = await("status", kMotionEnded, 0);
  begun.or_go_on = true;
  command(DriveVerb::Home) = {write("mode", kHoming), unless_set(write("homing_method", 17)),
                              write("control", kEnableOperation), write("control", kStart), begun};
  command(DriveVerb::Halt) = {write("control", kQuickStop)};
  command(DriveVerb::ClearStop) = {write("control", kEnableOperation), await("status", kStateMask, kOperationEnabled)};
  command(DriveVerb::FaultReset) = {write("control", 0), write("control", kFaultReset)};
  flag(DriveFlag::Moving, "status", kMotionEnded, 0);
  flag(DriveFlag::Homed, "status", kReferenced, kReferenced);
  flag(DriveFlag::Fault, "status", kFaultBit, kFaultBit);
  flag(DriveFlag::Enabled, "status", kStateMask, kOperationEnabled);
  flag(DriveFlag::Stopped, "status", kStateMask, kQuickStopActive);
  flag(DriveFlag::Tripped, "signals", 0x20, 0x20);
  flag(DriveFlag::FollowingError, "signals", 0x100, 0x100);
  flag(DriveFlag::AtLimit, "signals", 0x02, 0x02);
  map.boot_check = "speed";
  return map;
}

}  // namespace gonio::stage
