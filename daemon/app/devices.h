#pragma once

#include <memory>

#include "base/clock.h"
#include "daemon/app/engine.h"
#include "daemon/config/instrument.h"

namespace gonio::daemon {

/// The links and drivers of the instrument, as its file names them. Nothing is connected before the first call.
/// Threads: each driver is owned by one (EngineDevices).
class Devices {
 public:
  /// `clock` must outlive it; the instrument is copied.
  Devices(const Instrument& instrument, const Clock& clock);
  ~Devices();
  Devices(const Devices&) = delete;
  Devices& operator=(const Devices&) = delete;

  [[nodiscard]] EngineDevices all();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::daemon
