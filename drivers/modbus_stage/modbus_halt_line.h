#pragma once

#include <cstdint>

#include "drivers/links/modbus_link.h"
#include "drivers/stage.h"
#include "protocol/stage/register_map.h"

namespace gonio::drivers {

/// STOP and heartbeat over Modbus links that nobody else uses. `map` and the links must outlive it.
class ModbusHaltLine final : public HaltLine {
 public:
  /// A halt is written at most so often; the first may find a connection that broke unseen.
  static constexpr int kHaltTries = 3;

  /// One link for both, on a connection of its own.
  ModbusHaltLine(ModbusLink& link, const stage::RegisterMap& map) : ModbusHaltLine(link, link, map) {}
  /// On a line that is shared a halt interrupts what is in progress, and a beat does not.
  ModbusHaltLine(ModbusLink& halts, ModbusLink& beats, const stage::RegisterMap& map);

  Result<void> halt(Epoch epoch) override;
  Result<void> watch_heartbeat(Duration timeout) override;
  Result<void> beat() override;
  void interrupt() override;

 private:
  ModbusLink& halt_link_;
  ModbusLink& beat_link_;
  const stage::RegisterMap& map_;
  std::uint16_t beats_ = 0;
};

}  // namespace gonio::drivers
