#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "sim/wires/live_radiometer.h"

namespace gonio::sim {

/// USB with a port for each radiometer, as the simulator sees it. Threads of callers: any.
class UsbPorts {
 public:
  virtual ~UsbPorts() = default;

  /// The port's device appears under the next address, as without power before. Errors: Internal, WrongState (it is
  /// there).
  [[nodiscard]] virtual Result<void> plug(std::size_t port) = 0;
  /// It is gone; transfers under way end so. Does nothing when it is.
  virtual void unplug(std::size_t port) = 0;
  /// A fault may have been armed or ended that pulls a cable or puts it back.
  virtual void look_at_faults() = 0;
  /// What the environment of a program must have besides this process' own to find the devices.
  [[nodiscard]] virtual std::map<std::string, std::string> environment() const = 0;
};

/// Makes them, empty. The radiometers must outlive them.
using MakeUsbPorts = std::function<std::unique_ptr<UsbPorts>(const std::vector<LiveRadiometer*>& radiometers)>;

}  // namespace gonio::sim
