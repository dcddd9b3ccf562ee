#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include "protocol/stage/register_map.h"
#include "sim/devices/register_face.h"

namespace gonio::sim {

/// Registers that lie scattered over the address space, as a drive's do: what is not one of them is an illegal address.
class RegisterBank {
 public:
  void add(const stage::Register& reg, bool is_writable);

  [[nodiscard]] std::optional<ModbusException> read(std::uint16_t first, std::span<std::uint16_t> out) const;
  /// Nothing is written unless all may be.
  [[nodiscard]] std::optional<ModbusException> write(std::uint16_t first, std::span<const std::uint16_t> values);

  [[nodiscard]] std::int64_t get(const stage::Register& reg) const;
  /// Cut to the register's width.
  void set(const stage::Register& reg, std::int64_t value);
  void clear();

 private:
  struct Word {
    std::uint16_t value = 0;
    bool is_writable = false;
  };
  std::map<std::uint16_t, Word> words_;
};

/// Whether a write of `count` registers from `first` on covers the whole register.
[[nodiscard]] bool is_covered(const stage::Register& reg, std::uint16_t first, std::size_t count);

}  // namespace gonio::sim
