#include "protocol/stage/drive_stage_map.h"

#include <fmt/format.h>

#include <map>

namespace gonio::stage {
namespace {

constexpr NumberRange kPositive{.least = 1e-12};

DriveAxis read_axis(TomlReader& table, const DriveStageMap& map) {
  DriveAxis axis;
  if (table.kind("fixed") != TomlKind::Absent) {
    axis.fixed = table.number("fixed");
    return axis;
  }
  axis.unit_id = static_cast<std::uint8_t>(table.integer("unit_id", 1, 247));
  axis.map = table.text("map");
  if (!table.has_failed() && !map.maps.contains(axis.map)) {
    table.fail("map", ErrorCode::InvalidInput, fmt::format("\"{}\"", axis.map), "a name of [stage.drives.maps]");
  }
  axis.scale = table.number("scale");
  if (axis.scale == 0.0) table.fail("scale", ErrorCode::InvalidInput, "value 0", "any number but zero");
  axis.speed_scale = table.number("speed_scale", kPositive);
  axis.acceleration_scale = table.number("acceleration_scale", kPositive);
  return axis;
}

void claim(TomlReader& table, std::map<unsigned, std::string>& owners, unsigned unit, std::string_view name) {
  const auto [owner, is_new] = owners.emplace(unit, name);
  if (is_new) return;
  table.fail("unit_id", ErrorCode::InvalidInput, fmt::format("unit {} already belongs to {}", unit, owner->second),
             "one device for each unit id");
}

std::string axis_text(const DriveAxis& axis, Axis a, std::string_view prefix) {
  std::string text = fmt::format("\n[{}.axes.{}]\n", prefix, axis_name(a));
  if (axis.fixed) return text + fmt::format("fixed = {}\n", *axis.fixed);
  return text + fmt::format("unit_id = {}\nmap = \"{}\"\nscale = {}\nspeed_scale = {}\nacceleration_scale = {}\n",
                            axis.unit_id, axis.map, axis.scale, axis.speed_scale, axis.acceleration_scale);
}

}  // namespace

const DriveMap* DriveStageMap::map_of(Axis a) const {
  if (axis(a).fixed) return nullptr;
  const auto found = maps.find(axis(a).map);
  return found == maps.end() ? nullptr : &found->second;
}

DriveStageMap read_drive_stage_map(TomlReader& table) {
  DriveStageMap map;
  TomlReader maps = table.table("maps");
  for (const std::string& name : maps.keys()) {
    TomlReader one = maps.table(name);
    map.maps.emplace(name, read_drive_map(one));
  }
  std::map<unsigned, std::string> owners;
  TomlReader axes = table.table("axes");
  for (const Axis a : kAllAxes) {
    TomlReader one = axes.table(axis_name(a));
    DriveAxis& axis = map.axes[index_of(a)];
    axis = read_axis(one, map);
    if (!axis.fixed) claim(one, owners, axis.unit_id, axis_name(a));
  }
  if (auto io = table.optional_table("io")) {
    map.io = read_io_map(*io);
    claim(*io, owners, map.io->unit_id, "io");
  }
  return map;
}

std::string to_toml(const DriveStageMap& map, std::string_view prefix) {
  std::string text;
  for (const Axis a : kAllAxes) text += axis_text(map.axis(a), a, prefix);
  if (map.io) text += "\n" + to_toml(*map.io, fmt::format("{}.io", prefix));
  for (const auto& [name, drive] : map.maps) text += "\n" + to_toml(drive, fmt::format("{}.maps.{}", prefix, name));
  return text;
}

}  // namespace gonio::stage
