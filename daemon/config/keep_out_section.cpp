#include "daemon/config/keep_out_section.h"

#include "base/units.h"

namespace gonio::daemon {
namespace {

constexpr NumberRange kDistance{.least = 1.0, .most = 1e5, .unit = "mm"};
constexpr NumberRange kRadius{.least = 0.0, .most = 1e4, .unit = "mm"};

drivers::ArmHead read_head(TomlReader table) {
  const double nearest_mm = table.number("nearest_mm", kDistance);
  return {.nearest = millimetres(nearest_mm),
          .farthest = millimetres(table.number("farthest_mm", {.least = nearest_mm, .most = 1e5, .unit = "mm"})),
          .radius = millimetres(table.number("radius_mm", kRadius))};
}

}  // namespace

void read_keep_out(TomlReader& stage_table, drivers::StageConfig& stage) {
  auto table = stage_table.optional_table("keep_out");
  if (!table) return;
  const drivers::ArmHead source = read_head(table->table("source"));
  const drivers::ArmHead detector = read_head(table->table("detector"));
  stage.keep_out.emplace(source, detector, millimetres(table->number("margin_mm", kRadius)));
  if (stage.keep_out->least_separation() >= degrees(90.0) && !table->has_failed()) {
    table->fail("margin_mm", ErrorCode::InvalidInput, "the heads keep it at no angle below 90 deg",
                "heads that can pass each other");
  }
}

}  // namespace gonio::daemon
