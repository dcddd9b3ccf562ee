#pragma once

#include <cstdint>

#include "drivers/links/modbus_link.h"
#include "drivers/stage.h"
#include "protocol/stage/register_map.h"

namespace gonio::drivers {

/// STOP and heartbeat over a Modbus link of their own. `map` and `link` must outlive it.
class ModbusHaltLine final : public HaltLine {
 public:
  /// A halt is written at most so often; the first may find a connection that broke unseen.
  static constexpr int kHaltTries = 3;

  ModbusHaltLine(ModbusLink& link, const stage::RegisterMap& map);

  Result<void> halt(Epoch epoch) override;
  Result<void> watch_heartbeat(Duration timeout) override;
  Result<void> beat() override;
  void interrupt() override;

 private:
  ModbusLink& link_;
  const stage::RegisterMap& map_;
  std::uint16_t beats_ = 0;
};

}  // namespace gonio::drivers
