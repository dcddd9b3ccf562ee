#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/clock.h"
#include "drivers/links/camera_link.h"
#include "drivers/links/modbus_link.h"
#include "drivers/links/tape/tape_player.h"
#include "drivers/links/tape/tape_sink.h"
#include "drivers/links/usbtmc_link.h"
#include "drivers/stage.h"

namespace gonio::daemon {

/// What stands between the drivers and their links: nothing, a recording, or a tape in the links' place. Each link of a
/// party has a number of its own; the same at the replay. Everything handed out lives as long as the deck, and needs
/// what it was made of. Threads: made by one, then each link and clock belongs to its party's.
class TapeDeck {
 public:
  /// Neither records nor replays.
  explicit TapeDeck(const Clock& clock) : real_clock_(clock) {}
  TapeDeck(const Clock& clock, drivers::TapeSink& sink) : real_clock_(clock), sink_(&sink) {}
  TapeDeck(const Clock& clock, drivers::TapePlayer& player) : real_clock_(clock), player_(&player) {}

  [[nodiscard]] drivers::ModbusLink& modbus(drivers::ModbusLink& real, drivers::TapeParty party,
                                            std::uint8_t number = 0);
  [[nodiscard]] drivers::CameraLink& camera(drivers::CameraLink& real, drivers::TapeParty party);
  [[nodiscard]] drivers::UsbtmcLink& usbtmc(drivers::UsbtmcLink& real, drivers::TapeParty party);
  [[nodiscard]] const Clock& clock(drivers::TapeParty party);
  /// For the engine: recorded, or at a replay a line to nothing; the replay drives the real one itself.
  [[nodiscard]] drivers::HaltLine& halt_line(drivers::HaltLine& real);

  /// Null: nothing is recorded.
  [[nodiscard]] drivers::TapeSink* sink() const { return sink_; }

 private:
  const Clock& real_clock_;
  drivers::TapeSink* sink_ = nullptr;
  drivers::TapePlayer* player_ = nullptr;
  std::vector<std::unique_ptr<drivers::ModbusLink>> modbus_;
  std::vector<std::unique_ptr<drivers::CameraLink>> cameras_;
  std::vector<std::unique_ptr<drivers::UsbtmcLink>> usbtmc_;
  std::vector<std::unique_ptr<Clock>> clocks_;
  std::unique_ptr<drivers::HaltLine> halt_line_;
};

}  // namespace gonio::daemon
