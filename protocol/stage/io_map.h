#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/toml_reader.h"
#include "protocol/stage/drive_map.h"

namespace gonio::stage {

/// Bits of a register: true when (register AND mask) = value. As an output, `value` is written to the bits for true and
/// its complement within the mask for false; other bits stay.
struct IoBits {
  Register reg;
  std::int64_t mask = 1;
  std::int64_t value = 1;
  friend bool operator==(const IoBits&, const IoBits&) = default;
};

/// A number behind a register: offset + counts * scale, in the unit of what it is.
struct IoNumber {
  Register reg;
  double scale = 1.0;
  double offset = 0.0;
  friend bool operator==(const IoNumber&, const IoNumber&) = default;
};

/// An input/output coupler beside the drives, as data. Whatever is not there is left out.
struct IoMap {
  std::uint8_t unit_id = 1;
  ReadFunction reads = ReadFunction::Holding;
  WriteFunction writes = WriteFunction::Single;
  std::optional<IoBits> source_shutter;           ///< output: true opens
  std::optional<IoBits> detector_shutter;         ///< output: true opens
  std::optional<IoBits> source_shutter_open;      ///< input: true is fully open
  std::optional<IoBits> detector_shutter_open;    ///< input: true is fully open
  std::optional<IoBits> source_shutter_closed;    ///< input: true is fully closed
  std::optional<IoBits> detector_shutter_closed;  ///< input: true is fully closed
  std::optional<IoBits> interlock_open;           ///< input: true is open
  std::optional<IoNumber> monitor;
  std::optional<IoNumber> lamp_temperature_c;
  std::optional<IoNumber> detector_temperature_c;
  std::optional<IoNumber> room_temperature_c;
  std::optional<IoNumber> humidity_percent;
  friend bool operator==(const IoMap&, const IoMap&) = default;
};

/// Reads the table [stage.drives.io]. Errors stick in `table`.
[[nodiscard]] IoMap read_io_map(TomlReader& table);
/// The same as TOML text, under the heading `[prefix]`; read back it is equal.
[[nodiscard]] std::string to_toml(const IoMap& map, std::string_view prefix);

/// A coupler with all of it: process image of inputs from register 0, of outputs from 0x0800, as Beckhoff's BK9000 has
/// them.
[[nodiscard]] IoMap coupler_io_map(std::uint8_t unit_id);

}  // namespace gonio::stage
