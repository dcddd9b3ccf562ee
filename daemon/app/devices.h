#pragma once

#include <memory>

#include "daemon/app/engine.h"
#include "daemon/config/instrument.h"
#include "daemon/tape/tape_deck.h"

namespace gonio::daemon {

/// The links and drivers of the instrument, as its file names them. Nothing is connected before the first call.
/// Threads: each driver is owned by one (EngineDevices).
class Devices {
 public:
  /// Every link and clock passes through `deck`, which must outlive it; the instrument is copied.
  Devices(const Instrument& instrument, TapeDeck& deck);
  ~Devices();
  Devices(const Devices&) = delete;
  Devices& operator=(const Devices&) = delete;

  [[nodiscard]] EngineDevices all();
  /// The line itself, unrecorded: a replay makes it do its recorded turns.
  [[nodiscard]] drivers::HaltLine& halt_line();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::daemon
