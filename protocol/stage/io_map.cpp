#include "protocol/stage/io_map.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "protocol/stage/drive_toml.h"

namespace gonio::stage {
namespace {

struct NamedBits {
  std::string_view name;
  std::optional<IoBits> IoMap::*bits;
};
struct NamedNumber {
  std::string_view name;
  std::optional<IoNumber> IoMap::*number;
};

constexpr std::array kBits{NamedBits{"source_shutter", &IoMap::source_shutter},
                           NamedBits{"detector_shutter", &IoMap::detector_shutter},
                           NamedBits{"source_shutter_open", &IoMap::source_shutter_open},
                           NamedBits{"detector_shutter_open", &IoMap::detector_shutter_open},
                           NamedBits{"source_shutter_closed", &IoMap::source_shutter_closed},
                           NamedBits{"detector_shutter_closed", &IoMap::detector_shutter_closed},
                           NamedBits{"interlock_open", &IoMap::interlock_open}};
constexpr std::array kNumbers{NamedNumber{"monitor", &IoMap::monitor},
                              NamedNumber{"lamp_temperature_c", &IoMap::lamp_temperature_c},
                              NamedNumber{"detector_temperature_c", &IoMap::detector_temperature_c},
                              NamedNumber{"room_temperature_c", &IoMap::room_temperature_c},
                              NamedNumber{"humidity_percent", &IoMap::humidity_percent}};

IoBits read_bits(TomlReader table) {
  IoBits bits;
  bits.reg = read_register_here(table);
  const std::int64_t most = (std::int64_t{1} << (16 * bits.reg.words)) - 1;
  bits.mask = table.integer_or("mask", 1, 1, most);
  bits.value = table.integer_or("value", bits.mask, 0, most);
  if ((bits.value & ~bits.mask) != 0) {
    table.fail("value", ErrorCode::InvalidInput, fmt::format("value {:#x}", bits.value),
               fmt::format("no bits outside of the mask {:#x}", bits.mask));
  }
  return bits;
}

IoNumber read_number(TomlReader table) {
  IoNumber number;
  number.reg = read_register_here(table);
  number.scale = table.number("scale");
  number.offset = table.number_or("offset", 0.0);
  if (number.scale == 0.0) table.fail("scale", ErrorCode::InvalidInput, "value 0", "any number but zero");
  return number;
}

}  // namespace

IoMap read_io_map(TomlReader& table) {
  IoMap map;
  map.unit_id = static_cast<std::uint8_t>(table.integer("unit_id", 1, 247));
  std::tie(map.reads, map.writes) = read_functions(table, map.writes);
  for (const auto& [name, bits] : kBits) {
    if (auto entry = table.optional_table(name)) map.*bits = read_bits(*entry);
  }
  for (const auto& [name, number] : kNumbers) {
    if (auto entry = table.optional_table(name)) map.*number = read_number(*entry);
  }
  return map;
}

std::string to_toml(const IoMap& map, std::string_view prefix) {
  std::string text = fmt::format("[{}]\nunit_id = {}\n{}", prefix, map.unit_id, functions_text(map.reads, map.writes));
  for (const auto& [name, bits] : kBits) {
    if (const auto& it = map.*bits) {
      text +=
          fmt::format("{} = {{{}, mask = {:#x}, value = {:#x}}}\n", name, register_keys(it->reg), it->mask, it->value);
    }
  }
  for (const auto& [name, number] : kNumbers) {
    if (const auto& it = map.*number) {
      text +=
          fmt::format("{} = {{{}, scale = {}, offset = {}}}\n", name, register_keys(it->reg), it->scale, it->offset);
    }
  }
  return text;
}

IoMap coupler_io_map(std::uint8_t unit_id) {
  constexpr std::uint16_t kInputs = 0;
  constexpr std::uint16_t kOutputs = 0x0800;
  constexpr std::uint16_t kBitsAfterNumbers = 6;  // digital terminals come after analog ones in a process image
  const auto input = [](unsigned bit) {
    return IoBits{.reg = {.address = kInputs + kBitsAfterNumbers}, .mask = 1 << bit, .value = 1 << bit};
  };
  const auto output = [](unsigned bit) {
    return IoBits{.reg = {.address = kOutputs}, .mask = 1 << bit, .value = 1 << bit};
  };
  const auto temperature = [](std::uint16_t address) {
    return IoNumber{.reg = {.address = address, .is_signed = true},
                    .scale = 0.1};  // as resistance thermometers give it
  };
  IoMap map{.unit_id = unit_id};
  map.source_shutter = output(0);
  map.detector_shutter = output(1);
  map.source_shutter_open = input(0);
  map.detector_shutter_open = input(1);
  map.source_shutter_closed = input(2);
  map.detector_shutter_closed = input(3);
  map.interlock_open = input(4);
  map.monitor = IoNumber{.reg = {.address = kInputs, .words = 2}, .scale = 1e-7};
  map.lamp_temperature_c = temperature(kInputs + 2);
  map.detector_temperature_c = temperature(kInputs + 3);
  map.room_temperature_c = temperature(kInputs + 4);
  map.humidity_percent = IoNumber{.reg = {.address = kInputs + 5}, .scale = 0.1};
  return map;
}

}  // namespace gonio::stage
