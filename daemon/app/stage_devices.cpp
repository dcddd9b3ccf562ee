#include "daemon/app/stage_devices.h"

#include <optional>
#include <utility>
#include <vector>

#include "drivers/drive_stage/drive_halt_line.h"
#include "drivers/drive_stage/drive_stage.h"
#include "drivers/links/rtu_bus.h"
#include "drivers/links/tcp_modbus_link.h"
#include "drivers/modbus_stage/modbus_halt_line.h"
#include "drivers/modbus_stage/modbus_stage.h"

namespace gonio::daemon {

using drivers::TapeParty;

namespace {

/// The ways to the stage over its wire. Over TCP two connections; on a serial line, which there is but once, three
/// ranks.
class StageLinks {
 public:
  explicit StageLinks(const Instrument& instrument) {
    if (instrument.stage_address.serial) {
      bus_.emplace(drivers::RtuLineConfig{.line = *instrument.stage_address.serial,
                                          .unit_id = instrument.stage.registers.unit_id,
                                          .reply_timeout = instrument.stage.reply_timeout});
    } else {
      motion_.emplace(modbus(instrument));
      halt_.emplace(modbus(instrument));
    }
  }

  [[nodiscard]] drivers::ModbusLink& motion() { return bus_ ? bus_->normal() : *motion_; }
  /// STOP waits for nobody's exchange.
  [[nodiscard]] drivers::ModbusLink& halts() { return bus_ ? bus_->urgent() : *halt_; }
  [[nodiscard]] drivers::ModbusLink& beats() { return bus_ ? bus_->prompt() : *halt_; }

  using Unit = drivers::ModbusUnit;
  using Rank = drivers::RtuBus::Rank;
  [[nodiscard]] std::unique_ptr<drivers::ModbusLink> motion(const Unit& unit) {
    return bus_ ? bus_->for_unit(Rank::Normal, unit) : motion_->for_unit(unit);
  }
  [[nodiscard]] std::unique_ptr<drivers::ModbusLink> halts(const Unit& unit) {
    return bus_ ? bus_->for_unit(Rank::Urgent, unit) : halt_->for_unit(unit);
  }
  [[nodiscard]] std::unique_ptr<drivers::ModbusLink> beats(const Unit& unit) {
    return bus_ ? bus_->for_unit(Rank::Prompt, unit) : halt_->for_unit(unit);
  }

 private:
  static drivers::TcpModbusConfig modbus(const Instrument& instrument) {
    return {.address = instrument.stage_address.host,
            .port = instrument.stage_address.port,
            .unit_id = instrument.stage.registers.unit_id,
            .reply_timeout = instrument.stage.reply_timeout,
            .connect_timeout = instrument.stage.reply_timeout};
  }

  std::optional<drivers::RtuBus> bus_;
  std::optional<drivers::TcpModbusLink> motion_;
  std::optional<drivers::TcpModbusLink> halt_;
};

std::uint8_t tape_number(std::size_t number) {
  return static_cast<std::uint8_t>(number);
}

/// A way of one kind to each drive, and to the coupler, numbered for the tape in the order of the axes.
class UnitLinks {
 public:
  template <class Make, class Record>
  UnitLinks(const stage::DriveStageMap& map, Make make, Record record) {
    const auto add = [&](std::unique_ptr<drivers::ModbusLink> link, std::size_t number) {
      kept_.push_back(std::move(link));
      return record(*kept_.back(), number);
    };
    for (const stage::Axis axis : stage::kAllAxes) {
      const std::size_t a = stage::index_of(axis);
      const stage::DriveMap* drive = map.map_of(axis);
      if (drive != nullptr) links_.axes[a] = add(make({map.axis(axis).unit_id, drive->reads, drive->writes}), a);
    }
    if (map.io) links_.io = add(make({map.io->unit_id, map.io->reads, map.io->writes}), stage::kAxisCount);
  }
  [[nodiscard]] const drivers::DriveLinks& all() const { return links_; }

 private:
  std::vector<std::unique_ptr<drivers::ModbusLink>> kept_;
  drivers::DriveLinks links_;
};

}  // namespace

struct StageDevices::Kind {
  virtual ~Kind() = default;
  virtual drivers::Stage& stage() = 0;
  virtual drivers::HaltLine& halt_line() = 0;
};

struct StageDevices::Goniod final : Kind {
  Goniod(const Instrument& instrument, TapeDeck& deck)
      : links(instrument),
        driver(deck.modbus(links.motion(), TapeParty::Stage), instrument.stage, deck.clock(TapeParty::Stage)),
        line(deck.modbus(links.halts(), TapeParty::Halt, 0), deck.modbus(links.beats(), TapeParty::Halt, 1),
             instrument.stage.registers) {}
  drivers::Stage& stage() override { return driver; }
  drivers::HaltLine& halt_line() override { return line; }

  StageLinks links;
  drivers::ModbusStage driver;
  drivers::ModbusHaltLine line;
};

struct StageDevices::Drives final : Kind {
  using Unit = drivers::ModbusUnit;
  Drives(const Instrument& instrument, TapeDeck& deck)
      : links(instrument),
        motion(
            *instrument.stage.drives, [&](const Unit& unit) { return links.motion(unit); },
            [&](drivers::ModbusLink& link, std::size_t k) {
              return &deck.modbus(link, TapeParty::Stage, tape_number(k));
            }),
        halts(
            *instrument.stage.drives, [&](const Unit& unit) { return links.halts(unit); },
            [&](drivers::ModbusLink& link, std::size_t k) {
              return &deck.modbus(link, TapeParty::Halt, tape_number(2 * k));
            }),
        beats(
            *instrument.stage.drives, [&](const Unit& unit) { return links.beats(unit); },
            [&](drivers::ModbusLink& link, std::size_t k) {
              return &deck.modbus(link, TapeParty::Halt, tape_number(2 * k + 1));
            }),
        driver(motion.all(), instrument.stage, latch, deck.clock(TapeParty::Stage)),
        line(halts.all(), beats.all(), instrument.stage, latch, deck.clock(TapeParty::Halt)) {}
  drivers::Stage& stage() override { return driver; }
  drivers::HaltLine& halt_line() override { return line; }

  StageLinks links;
  drivers::DriveLatch latch;
  UnitLinks motion;
  UnitLinks halts;
  UnitLinks beats;
  drivers::DriveStage driver;
  drivers::DriveHaltLine line;
};

StageDevices::StageDevices(const Instrument& instrument, TapeDeck& deck) {
  if (instrument.stage.drives) {
    kind_ = std::make_unique<Drives>(instrument, deck);
  } else {
    kind_ = std::make_unique<Goniod>(instrument, deck);
  }
}

StageDevices::~StageDevices() = default;

drivers::Stage& StageDevices::stage() {
  return kind_->stage();
}
drivers::HaltLine& StageDevices::halt_line() {
  return kind_->halt_line();
}

}  // namespace gonio::daemon
