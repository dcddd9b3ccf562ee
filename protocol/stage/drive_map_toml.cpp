// Drives, couplers and the stage that they make, as TOML.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "protocol/stage/drive_map.h"
#include "protocol/stage/drive_toml.h"

namespace gonio::stage {

namespace {

constexpr std::array<std::string_view, 2> kReads{"holding", "input"};
constexpr std::array<std::string_view, 2> kWrites{"single", "multiple"};
constexpr std::int64_t kMost = 0xFFFFFFFF;
constexpr int kMostLooks = 10000;

// The named register, which must be one of the map's. An empty name after an error.
std::string register_name(TomlReader& table, std::string_view key, const DriveMap& map) {
  std::string name = table.text(key);
  if (table.has_failed() || map.find(name) != nullptr) return name;
  std::string known;
  for (const auto& [other, reg] : map.registers) known += (known.empty() ? "" : ", ") + other;
  table.fail(key, ErrorCode::InvalidInput, fmt::format("\"{}\"", name), "a name of its registers: " + known);
  return name;
}

void read_value(TomlReader& table, DriveStep& step) {
  if (table.kind("value") != TomlKind::Text) {
    step.value = table.integer("value", -kMost - 1, kMost);
    return;
  }
  constexpr std::array<std::string_view, 5> kNames{"target", "speed", "acceleration", "low_limit", "high_limit"};
  step.source = static_cast<DriveValue>(1 + table.choice("value", kNames));
}

DriveStep read_step(TomlReader& table, const DriveMap& map) {
  DriveStep step;
  const bool waits = table.kind("await") != TomlKind::Absent;
  step.kind = waits ? DriveStep::Kind::Await : DriveStep::Kind::Write;
  step.reg = register_name(table, waits ? "await" : "write", map);
  if (waits) {
    step.mask = table.integer("mask", 1, kMost);
    step.value = table.integer("value", 0, kMost);
    step.or_go_on = table.flag_or("or_go_on", false);
  } else {
    step.mask = table.integer_or("mask", 0, 0, kMost);
    read_value(table, step);
    step.unless_set = table.flag_or("unless_set", false);
  }
  if (step.source == DriveValue::Fixed && step.mask != 0 && (step.value & ~step.mask) != 0) {
    table.fail("value", ErrorCode::InvalidInput, fmt::format("value {:#x}", step.value),
               fmt::format("no bits outside of the mask {:#x}", step.mask));
  }
  return step;
}

bool may_be_absent(DriveVerb verb) {
  return verb == DriveVerb::Setup || verb == DriveVerb::Enable || verb == DriveVerb::ClearStop;
}

void read_commands(TomlReader table, DriveMap& map) {
  for (std::size_t v = 0; v < kDriveVerbCount; ++v) {
    const auto verb = static_cast<DriveVerb>(v);
    for (TomlReader& step : table.tables(verb_name(verb))) map.commands[v].push_back(read_step(step, map));
    if (!map.commands[v].empty() || may_be_absent(verb)) continue;
    table.fail(verb_name(verb), ErrorCode::MissingKey, "the drive is not told how",
               "at least one step, {write = ..., value = ...}");
  }
}

void read_flags(TomlReader table, DriveMap& map) {
  for (std::size_t f = 0; f < kDriveFlagCount; ++f) {
    const auto flag = static_cast<DriveFlag>(f);
    const bool must_be = flag <= DriveFlag::Enabled;
    auto entry = must_be ? std::optional(table.table(flag_name(flag))) : table.optional_table(flag_name(flag));
    if (!entry) continue;
    DriveCondition condition{register_name(*entry, "register", map), entry->integer("mask", 1, kMost),
                             entry->integer("value", 0, kMost)};
    if ((condition.value & ~condition.mask) != 0) {
      entry->fail("value", ErrorCode::InvalidInput, fmt::format("value {:#x}", condition.value),
                  fmt::format("no bits outside of the mask {:#x}", condition.mask));
    }
    map.flags[f] = std::move(condition);
  }
}

void read_registers(TomlReader table, DriveMap& map) {
  for (const std::string& name : table.keys()) map.registers.emplace(name, read_plain_register(table, name));
  if (map.find("position") == nullptr) {
    table.fail("position", ErrorCode::MissingKey, "the drive has no position", "a register of that name");
  }
}

// What Setup leaves in a register can be told from what a power-up leaves only where Setup writes it.
void check_boot_check(TomlReader& table, const DriveMap& map) {
  const auto writes_it = [&](const DriveStep& step) {
    return step.kind == DriveStep::Kind::Write && step.reg == map.boot_check && step.mask == 0;
  };
  if (map.boot_check.empty() || std::ranges::any_of(map.command(DriveVerb::Setup), writes_it)) return;
  table.fail("boot_check", ErrorCode::InvalidInput, fmt::format("\"{}\"", map.boot_check),
             "a register that commands.setup writes whole");
}

std::string step_text(const DriveStep& step) {
  const bool waits = step.kind == DriveStep::Kind::Await;
  std::string text = fmt::format("{{{} = \"{}\"", waits ? "await" : "write", step.reg);
  if (step.mask != 0) text += fmt::format(", mask = {:#x}", step.mask);
  if (step.source != DriveValue::Fixed) {
    text += fmt::format(", value = \"{}\"", value_name(step.source));
  } else {
    text += step.value < 0 ? fmt::format(", value = {}", step.value) : fmt::format(", value = {:#x}", step.value);
  }
  if (step.unless_set) text += ", unless_set = true";
  if (step.or_go_on) text += ", or_go_on = true";
  return text + "}";
}

std::string command_text(std::string_view name, const DriveCommand& command) {
  std::string text = fmt::format("{} = [", name);
  for (std::size_t k = 0; k < command.size(); ++k) {
    text += fmt::format("{}\n  {}", k == 0 ? "" : ",", step_text(command[k]));
  }
  return text + "]\n";
}

}  // namespace

Register read_plain_register(TomlReader& table, std::string_view name) {
  TomlReader entry = table.table(name);
  return read_register_here(entry);
}

Register read_register_here(TomlReader& entry) {
  constexpr std::int64_t kLastAddress = 0xFFFF;
  Register reg;
  reg.words = static_cast<std::uint8_t>(entry.integer_or("words", 1, 1, 2));
  reg.address = static_cast<std::uint16_t>(entry.integer("address", 0, kLastAddress + 1 - reg.words));
  reg.is_signed = entry.flag_or("signed", false);
  reg.low_word_first = entry.flag_or("low_word_first", false);
  return reg;
}

std::string register_keys(const Register& reg) {
  return fmt::format("address = {}, words = {}{}{}", reg.address, reg.words, reg.is_signed ? ", signed = true" : "",
                     reg.low_word_first ? ", low_word_first = true" : "");
}

Functions read_functions(TomlReader& table, WriteFunction usual) {
  return {static_cast<ReadFunction>(table.choice_or("read_registers", 0, kReads)),
          static_cast<WriteFunction>(table.choice_or("write_register", static_cast<std::size_t>(usual), kWrites))};
}

std::string functions_text(ReadFunction reads, WriteFunction writes) {
  return fmt::format("read_registers = \"{}\"\nwrite_register = \"{}\"\n", kReads[static_cast<std::size_t>(reads)],
                     kWrites[static_cast<std::size_t>(writes)]);
}

DriveMap read_drive_map(TomlReader& table) {
  DriveMap map;
  std::tie(map.reads, map.writes) = read_functions(table, map.writes);
  map.looks = static_cast<int>(table.integer_or("looks", map.looks, 1, kMostLooks));
  map.watchdog_s_per_count = table.number_or("watchdog_s_per_count", map.watchdog_s_per_count, {.least = 1e-6});
  read_registers(table.table("registers"), map);
  read_commands(table.table("commands"), map);
  read_flags(table.table("status"), map);
  if (table.kind("boot_check") != TomlKind::Absent) map.boot_check = register_name(table, "boot_check", map);
  check_boot_check(table, map);
  return map;
}

std::string to_toml(const DriveMap& map, std::string_view prefix) {
  std::string text = fmt::format("[{}]\n{}looks = {}\nwatchdog_s_per_count = {}\n", prefix,
                                 functions_text(map.reads, map.writes), map.looks, map.watchdog_s_per_count);
  if (!map.boot_check.empty()) text += fmt::format("boot_check = \"{}\"\n", map.boot_check);
  text += fmt::format("\n[{}.registers]\n", prefix);
  for (const auto& [name, reg] : map.registers) text += fmt::format("{} = {{{}}}\n", name, register_keys(reg));
  text += fmt::format("\n[{}.commands]\n", prefix);
  for (std::size_t v = 0; v < kDriveVerbCount; ++v) {
    if (!map.commands[v].empty()) text += command_text(verb_name(static_cast<DriveVerb>(v)), map.commands[v]);
  }
  text += fmt::format("\n[{}.status]\n", prefix);
  for (std::size_t f = 0; f < kDriveFlagCount; ++f) {
    const auto& condition = map.flags[f];
    if (!condition) continue;
    text += fmt::format("{} = {{register = \"{}\", mask = {:#x}, value = {:#x}}}\n",
                        flag_name(static_cast<DriveFlag>(f)), condition->reg, condition->mask, condition->value);
  }
  return text;
}

}  // namespace gonio::stage
