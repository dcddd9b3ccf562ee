#include "daemon/tape/tape_deck.h"

#include "daemon/tape/taped_halt_line.h"
#include "drivers/links/tape/replay_links.h"
#include "drivers/links/tape/taped_camera_link.h"
#include "drivers/links/tape/taped_clock.h"
#include "drivers/links/tape/taped_modbus_link.h"
#include "drivers/links/tape/taped_usbtmc_link.h"

namespace gonio::daemon {

drivers::ModbusLink& TapeDeck::modbus(drivers::ModbusLink& real, drivers::TapeParty party, std::uint8_t number) {
  if (sink_ != nullptr) {
    const drivers::TapeChannel channel(*sink_, real_clock_, party, number);
    return *modbus_.emplace_back(std::make_unique<drivers::TapedModbusLink>(real, channel));
  }
  if (player_ != nullptr) {
    return *modbus_.emplace_back(std::make_unique<drivers::ReplayModbusLink>(*player_, party, number));
  }
  return real;
}

drivers::CameraLink& TapeDeck::camera(drivers::CameraLink& real, drivers::TapeParty party) {
  if (sink_ != nullptr) {
    const drivers::TapeChannel channel(*sink_, real_clock_, party);
    return *cameras_.emplace_back(std::make_unique<drivers::TapedCameraLink>(real, channel));
  }
  if (player_ != nullptr) {
    return *cameras_.emplace_back(std::make_unique<drivers::ReplayCameraLink>(*player_, party));
  }
  return real;
}

drivers::UsbtmcLink& TapeDeck::usbtmc(drivers::UsbtmcLink& real, drivers::TapeParty party) {
  if (sink_ != nullptr) {
    const drivers::TapeChannel channel(*sink_, real_clock_, party);
    return *usbtmc_.emplace_back(std::make_unique<drivers::TapedUsbtmcLink>(real, channel));
  }
  if (player_ != nullptr) {
    return *usbtmc_.emplace_back(std::make_unique<drivers::ReplayUsbtmcLink>(*player_, party));
  }
  return real;
}

const Clock& TapeDeck::clock(drivers::TapeParty party) {
  if (sink_ != nullptr) {
    return *clocks_.emplace_back(std::make_unique<drivers::TapedClock>(*sink_, real_clock_, party));
  }
  if (player_ != nullptr) return *clocks_.emplace_back(std::make_unique<drivers::ReplayClock>(*player_, party));
  return real_clock_;
}

drivers::HaltLine& TapeDeck::halt_line(drivers::HaltLine& real) {
  if (sink_ != nullptr) {
    halt_line_ = std::make_unique<TapedHaltLine>(real, *sink_, real_clock_);
  } else if (player_ != nullptr) {
    halt_line_ = std::make_unique<IdleHaltLine>();
  } else {
    return real;
  }
  return *halt_line_;
}

}  // namespace gonio::daemon
