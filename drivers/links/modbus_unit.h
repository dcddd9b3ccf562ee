#pragma once

#include <cstdint>

#include "protocol/stage/drive_map.h"

namespace gonio::drivers {

/// One unit on a Modbus line or behind a gateway, and which functions it understands.
struct ModbusUnit {
  std::uint8_t unit_id = 1;
  stage::ReadFunction reads = stage::ReadFunction::Holding;
  stage::WriteFunction writes = stage::WriteFunction::Single;  ///< of one register; several are always FC16
};

}  // namespace gonio::drivers
