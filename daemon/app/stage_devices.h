#pragma once

#include <memory>

#include "daemon/config/instrument.h"
#include "daemon/tape/tape_deck.h"
#include "drivers/stage.h"

namespace gonio::daemon {

/// The stage with its links, of whichever kind and on whichever wire the instrument's file says. Nothing is connected
/// before the first call. Threads: stage and halt line each have one.
class StageDevices {
 public:
  /// Every link and clock passes through `deck`. Both must outlive it.
  StageDevices(const Instrument& instrument, TapeDeck& deck);
  ~StageDevices();
  StageDevices(const StageDevices&) = delete;
  StageDevices& operator=(const StageDevices&) = delete;

  [[nodiscard]] drivers::Stage& stage();
  [[nodiscard]] drivers::HaltLine& halt_line();

 private:
  struct Kind;
  struct Goniod;
  struct Drives;
  std::unique_ptr<Kind> kind_;
};

}  // namespace gonio::daemon
