#include "daemon/config/drives_section.h"

#include <array>
#include <string_view>

#include "protocol/stage/drive_stage_map.h"

namespace gonio::daemon {
namespace {

// An axis without a drive has no counts: its place is its offset.
void take_scales(drivers::StageConfig& stage) {
  for (const stage::Axis a : stage::kAllAxes) {
    const stage::DriveAxis& axis = stage.drives->axis(a);
    stage.registers.axis_scale[stage::index_of(a)] = axis.fixed ? 1.0 : axis.scale;
    if (axis.fixed) stage.axes[stage::index_of(a)].offset = *axis.fixed;
  }
}

}  // namespace

void read_stage_kind(TomlReader& table, drivers::StageConfig& stage) {
  constexpr std::array<std::string_view, 2> kKinds{"goniod", "drives"};
  if (kKinds[table.choice_or("kind", 0, kKinds)] == "goniod") {
    TomlReader registers = table.table("registers");
    stage.registers = stage::read_register_map(registers);
    return;
  }
  TomlReader drives = table.table("drives");
  stage.drives = stage::read_drive_stage_map(drives);
  stage.has_gate = false;
  take_scales(stage);
}

}  // namespace gonio::daemon
