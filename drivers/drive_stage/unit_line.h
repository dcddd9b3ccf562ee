#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "base/clock.h"
#include "base/result.h"
#include "drivers/links/modbus_link.h"
#include "protocol/stage/register_map.h"

namespace gonio::drivers {

/// The registers of one unit that has no token: each read and each write is tried again, at most `tries` times in all,
/// as everything written here may arrive twice. After a failure the line is emptied first, since a reply here bears
/// nothing that tells it from a late one. A unit that has been silent for `patience` is tried once, and what was
/// TimedOut is then Unreachable. Threads: owned by one.
class UnitLine {
 public:
  static constexpr int kTries = 3;
  /// How often one call, unless it has one try only, begins anew after giving way to a halt on the same wire.
  static constexpr int kMostGivenWay = 32;

  /// `link` and `clock` must outlive it; `name` ("theta_r") stands in errors.
  UnitLine(ModbusLink& link, const Clock& clock, std::string name, Duration patience, int tries = kTries);

  /// Errors: those of ModbusLink, with the name and what was to be done.
  [[nodiscard]] Result<std::int64_t> read(const stage::Register& reg, const std::string& what);
  /// `value` is cut to the register's width.
  [[nodiscard]] Result<void> write(const stage::Register& reg, std::int64_t value, const std::string& what);
  /// Changes the bits of `mask` only: reads first.
  [[nodiscard]] Result<void> write_bits(const stage::Register& reg, std::int64_t mask, std::int64_t value,
                                        const std::string& what);
  /// A run of registers in one transaction.
  [[nodiscard]] Result<void> read_run(std::uint16_t first, std::span<std::uint16_t> into, const std::string& what);

  [[nodiscard]] Error error(ErrorCode code, std::string tried, std::string seen, std::string limit = {}) const;

 private:
  template <class Exchange>
  [[nodiscard]] Result<void> talk(const std::string& what, Exchange exchange);
  [[nodiscard]] bool is_given_up() const;

  ModbusLink& link_;
  const Clock& clock_;
  std::string name_;
  Duration patience_;
  int tries_;
  std::optional<Instant> silent_since_;
};

}  // namespace gonio::drivers
