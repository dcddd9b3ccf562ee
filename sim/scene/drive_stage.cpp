#include "sim/scene/drive_stage.h"

#include <cmath>

namespace gonio::sim {

stage::DriveStageMap drive_stage_of(const StageSpec& stage) {
  constexpr std::uint8_t kCoupler = 20;
  constexpr double kAccelerationStep = 1000.0;  // a simulator in fast motion accelerates beyond 32 bits of fine steps
  stage::DriveStageMap map;
  map.maps.emplace("lexium32", stage::lexium32_drive_map());
  std::uint8_t unit = 1;
  for (const stage::Axis a : stage::kAllAxes) {
    const double scale = stage.registers.axis_scale[stage::index_of(a)];
    map.axes[stage::index_of(a)] = {.unit_id = unit++,
                                    .map = "lexium32",
                                    .scale = scale,
                                    .speed_scale = std::abs(scale),
                                    .acceleration_scale = kAccelerationStep * std::abs(scale),
                                    .fixed = std::nullopt};
  }
  map.io = stage::coupler_io_map(kCoupler);
  return map;
}

}  // namespace gonio::sim
