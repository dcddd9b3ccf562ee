#pragma once

#include <cstdint>
#include <string>

#include "sim/scene/scene.h"

namespace gonio::sim {

/// Where the wires of one run are found.
struct WireAddresses {
  std::string stage_host = "127.0.0.1";
  std::uint16_t stage_port = 1502;
  std::string
      stage_line;  ///< not empty: the stage is on Modbus RTU behind this path, 8 data bits, no parity, 2 stop bits
  int stage_baud = 115200;
  std::string camera_address = "127.0.7.1";
};

/// The instrument.toml that describes this scene's instrument to the daemon, all in wall time, as
/// packaging/instrument.example.toml has it. Nothing in it tells the truth of the seed.
[[nodiscard]] std::string instrument_toml(const Scene& scene, const WireAddresses& addresses);

/// The file of the reference standard: certificate, uncertainties, and the shape as a table of `shape_grid`, without
/// any draw.
[[nodiscard]] std::string reference_toml(const ReferenceSpec& reference);

}  // namespace gonio::sim
