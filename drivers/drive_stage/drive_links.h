#pragma once

#include "drivers/links/modbus_link.h"
#include "protocol/stage/axis.h"

namespace gonio::drivers {

/// The ways to the units of a stage of drives, all for one thread. Null where an axis has no drive, or there is no
/// coupler.
struct DriveLinks {
  stage::PerAxis<ModbusLink*> axes{};
  ModbusLink* io = nullptr;
};

}  // namespace gonio::drivers
