#pragma once

#include <cstdint>
#include <string>

namespace gonio::drivers {

enum class Parity : std::uint8_t { None, Even, Odd };

/// A serial line as the instrument's file has it; 8 data bits. RS-485 converters that switch direction by themselves
/// look the same; the kernel's own RS-485 mode is left as it is set.
struct SerialLine {
  std::string device;  ///< "/dev/ttyUSB0", or a link to such a thing
  int baud = 115200;   ///< one of kBaudRates
  Parity parity = Parity::Even;
  int stop_bits = 1;  ///< 1 or 2
};

/// What may stand in `baud`: libmodbus takes anything else for 9600.
inline constexpr int kBaudRates[] = {9600, 19200, 38400, 57600, 115200, 230400, 460800, 921600};

}  // namespace gonio::drivers
