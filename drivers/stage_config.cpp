#include "drivers/stage_config.h"

#include <cmath>

namespace gonio::drivers {

double position_of(const StageConfig& config, stage::Axis axis, std::int64_t counts) {
  const double scale = config.registers.axis_scale[stage::index_of(axis)];
  return config.axis(axis).offset + static_cast<double>(counts) * scale;
}

std::int64_t counts_of(const StageConfig& config, stage::Axis axis, double position) {
  const double scale = config.registers.axis_scale[stage::index_of(axis)];
  return std::llround((position - config.axis(axis).offset) / scale);
}

}  // namespace gonio::drivers
