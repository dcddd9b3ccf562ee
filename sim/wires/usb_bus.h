#pragma once

#include <memory>

#include "base/result.h"
#include "sim/wires/live_radiometer.h"

namespace gonio::sim {

/// USB as this process would have it with one port for a radiometer: sysfs, the device's node, usbfs, uevents, by
/// umockdev. An unmodified libusb, in this process or in a child, finds and drives the device. Needs
/// libumockdev-preload in front of libc: linked, as the target gonio_sim_usb does, or by LD_PRELOAD.
///
/// In wall time only: a reply that is due later is announced when the clock's time has passed. One bus a process at a
/// time. Two threads: umockdev's, which serves libusb, and one for what is due. Threads of callers: any.
class UsbBus {
 public:
  /// The port is empty at first. `radiometer` must outlive it; users of libusb must have ended before it does.
  explicit UsbBus(LiveRadiometer& radiometer);
  ~UsbBus();
  UsbBus(const UsbBus&) = delete;
  UsbBus& operator=(const UsbBus&) = delete;

  /// The device appears under the next address, as without power before. Errors: Internal, WrongState (it is there).
  [[nodiscard]] Result<void> plug();
  /// It is gone; transfers under way end so. Does nothing when it is.
  void unplug();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::sim
