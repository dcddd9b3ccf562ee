// The register map as TOML: one inline table a register, one table an axis.
#include <fmt/format.h>

#include <map>

#include "protocol/stage/drive_toml.h"
#include "protocol/stage/register_map.h"

namespace gonio::stage {
namespace {

constexpr std::uint16_t kMostReadAtOnce = 125;  // of FC3 and FC23 (Modbus Application Protocol V1.1b3, 6.17)

double read_scale(TomlReader& table, std::string_view key) {
  const double scale = table.number(key);
  if (scale == 0.0) table.fail(key, ErrorCode::InvalidInput, "value 0", "any number but zero");
  return scale;
}

// Who lies on which word of the stage's address space.
class Owners {
 public:
  void claim(TomlReader& table, std::string_view key, const Register& reg, std::string_view axis = {}) {
    const std::string name = axis.empty() ? std::string(key) : fmt::format("{}.{}", axis, key);
    for (unsigned word = reg.address; word < reg.address + unsigned{reg.words}; ++word) {
      const auto [owner, is_new] = owner_.emplace(word, name);
      if (is_new) continue;
      table.fail(key, ErrorCode::InvalidInput, fmt::format("register {} already belongs to {}", word, owner->second),
                 "one value for each register");
    }
  }

 private:
  std::map<unsigned, std::string> owner_;
};

unsigned words_of(const RegisterMap& map, std::initializer_list<Field> fields) {
  unsigned words = 0;
  for (const Field field : fields) words += map.at(field).words;
  return words;
}

unsigned words_of_motion(const RegisterMap& map) {
  unsigned words = words_of(map, {Field::MotionEpoch, Field::MotionToken, Field::MotionMask, Field::MotionCommand});
  for (const Axis axis : kAllAxes) words += map.at(axis, AxisField::Target).words;
  return words;
}

// A command is one write: a foreign register inside its run would be overwritten with every command.
void need_without_gap(TomlReader& table, Field field, Block block, unsigned words) {
  if (block.count == words) return;
  table.fail(
      field_name(field), ErrorCode::InvalidInput,
      fmt::format("its command spans {} registers from {}, of which {} belong to it", block.count, block.first, words),
      "a run without gaps");
}

void check_blocks(TomlReader& table, const RegisterMap& map) {
  const Block status = map.status_block();
  if (status.count > kMostReadAtOnce) {
    table.fail(field_name(Field::Token), ErrorCode::InvalidInput,
               fmt::format("the status block spans {} registers from {}", status.count, status.first),
               fmt::format("at most {} registers", kMostReadAtOnce));
  }
  need_without_gap(table, Field::MotionCommand, map.motion_block(), words_of_motion(map));
  need_without_gap(table, Field::HaltKey, map.halt_block(), words_of(map, {Field::HaltEpoch, Field::HaltKey}));
  need_without_gap(table, Field::ResetKey, map.reset_block(), words_of(map, {Field::ResetEpoch, Field::ResetKey}));
  need_without_gap(table, Field::SourceShutterCommand, map.shutter_block(),
                   words_of(map, {Field::SourceShutterCommand, Field::DetectorShutterCommand}));
  const Block motion = map.motion_block();
  const Register& command = map.at(Field::MotionCommand);
  if (command.address + unsigned{command.words} != unsigned{motion.first} + motion.count) {
    table.fail(field_name(Field::MotionCommand), ErrorCode::InvalidInput,
               fmt::format("register {} is not the last of its command", command.address),
               "the stage acts on the last register written");
  }
}

std::string register_text(std::string_view name, const Register& reg) {
  return fmt::format("{} = {{address = {}, words = {}{}{}}}\n", name, reg.address, reg.words,
                     reg.is_signed ? ", signed = true" : "", reg.low_word_first ? ", low_word_first = true" : "");
}

}  // namespace

RegisterMap read_register_map(TomlReader& table) {
  RegisterMap map;
  Owners owners;
  map.unit_id = static_cast<std::uint8_t>(table.integer("unit_id", 0, 255));
  map.monitor_scale = read_scale(table, "monitor_scale");
  map.temperature_scale_c = read_scale(table, "temperature_scale_c");
  map.humidity_scale_percent = read_scale(table, "humidity_scale_percent");
  for (std::size_t i = 0; i < kFieldCount; ++i) {
    const std::string_view name = field_name(static_cast<Field>(i));
    map.fields[i] = read_plain_register(table, name);
    owners.claim(table, name, map.fields[i]);
  }
  TomlReader axes = table.table("axes");
  for (const Axis axis : kAllAxes) {
    TomlReader one = axes.table(axis_name(axis));
    map.axis_scale[index_of(axis)] = read_scale(one, "scale");
    for (std::size_t i = 0; i < kAxisFieldCount; ++i) {
      const std::string_view name = field_name(static_cast<AxisField>(i));
      map.axes[index_of(axis)][i] = read_plain_register(one, name);
      owners.claim(one, name, map.axes[index_of(axis)][i], axis_name(axis));
    }
  }
  check_blocks(table, map);
  return map;
}

std::string to_toml(const RegisterMap& map, std::string_view prefix) {
  std::string text =
      fmt::format("[{}]\nunit_id = {}\nmonitor_scale = {}\ntemperature_scale_c = {}\nhumidity_scale_percent = {}\n",
                  prefix, map.unit_id, map.monitor_scale, map.temperature_scale_c, map.humidity_scale_percent);
  for (std::size_t i = 0; i < kFieldCount; ++i) {
    text += register_text(field_name(static_cast<Field>(i)), map.fields[i]);
  }
  for (const Axis axis : kAllAxes) {
    text += fmt::format("\n[{}.axes.{}]  # scale: {} per count\nscale = {}\n", prefix, axis_name(axis), axis_unit(axis),
                        map.axis_scale[index_of(axis)]);
    for (std::size_t i = 0; i < kAxisFieldCount; ++i) {
      text += register_text(field_name(static_cast<AxisField>(i)), map.axes[index_of(axis)][i]);
    }
  }
  return text;
}

}  // namespace gonio::stage
