#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "sim/wires/usb_ports.h"

namespace gonio::sim {

/// USB as this process would have it with a port for each radiometer: sysfs, the devices' nodes, usbfs, uevents, by
/// umockdev. An unmodified libusb, in this process or in a child, finds and drives the devices. Needs
/// libumockdev-preload in front of libc: linked, as the target gonio_sim_usb does, or by LD_PRELOAD.
///
/// In wall time only: a reply that is due later is announced when the clock's time has passed. One bus a process at a
/// time. Threads: umockdev's, which serves libusb, and one a port for what is due. Threads of callers: any.
class UsbBus final : public UsbPorts {
 public:
  /// The ports are empty at first. The radiometers must outlive it; users of libusb must have ended before it does.
  explicit UsbBus(const std::vector<LiveRadiometer*>& radiometers);
  explicit UsbBus(LiveRadiometer& radiometer) : UsbBus(std::vector<LiveRadiometer*>{&radiometer}) {}
  ~UsbBus() override;
  UsbBus(const UsbBus&) = delete;
  UsbBus& operator=(const UsbBus&) = delete;

  [[nodiscard]] Result<void> plug(std::size_t port) override;
  void unplug(std::size_t port) override;
  void look_at_faults() override;
  /// The only port there is.
  [[nodiscard]] Result<void> plug() { return plug(0); }
  void unplug() { unplug(0); }
  [[nodiscard]] std::map<std::string, std::string> environment() const override;

 private:
  struct System;
  struct Port;
  std::unique_ptr<System> system_;
  std::vector<std::unique_ptr<Port>> ports_;
};

}  // namespace gonio::sim
