#pragma once

#include <cstdint>
#include <map>
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
  std::map<std::string, std::string> usb_environment;  ///< what a program needs to see the emulated USB; empty: none
};

/// The instrument.toml that describes this scene's instrument to the daemon, all in wall time, as
/// packaging/instrument.example.toml has it. Nothing in it tells the truth of the seed.
[[nodiscard]] std::string instrument_toml(const Scene& scene, const WireAddresses& addresses);

/// The sections of a radiometer that serves as detector or as monitor, in wall time; empty when the scene has none.
[[nodiscard]] std::string radiometer_detector_section(const Scene& scene);
[[nodiscard]] std::string radiometer_monitor_section(const Scene& scene);
/// The radiometer of that place, or nullptr.
[[nodiscard]] const RadiometerSpec* radiometer_at(const Scene& scene, RadiometerPlace place);

/// The file of the reference standard: certificate, uncertainties, and the shape as a table of `shape_grid`, without
/// any draw.
[[nodiscard]] std::string reference_toml(const ReferenceSpec& reference);

}  // namespace gonio::sim
