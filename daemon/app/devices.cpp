#include "daemon/app/devices.h"

#include <optional>

#include "drivers/genicam_camera/genicam_camera.h"
#include "drivers/links/aravis_camera_link.h"
#include "drivers/links/rtu_bus.h"
#include "drivers/links/tcp_modbus_link.h"
#include "drivers/modbus_stage/modbus_halt_line.h"
#include "drivers/modbus_stage/modbus_stage.h"

namespace gonio::daemon {
namespace {

using drivers::TapeParty;

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

drivers::AravisCameraConfig camera_link_of(const DetectorConfig& detector) {
  const bool is_usb = detector.link == CameraLinkKind::Usb3;
  return {.address = detector.address,
          .serial = detector.serial,
          .transport = is_usb ? drivers::CameraTransport::Usb3 : drivers::CameraTransport::Gige};
}

drivers::GenicamCameraConfig camera_of(const DetectorConfig& detector) {
  return {.serial = detector.serial,
          .format = {.width = detector.width_px,
                     .height = detector.height_px,
                     .offset_x = detector.offset_x_px,
                     .offset_y = detector.offset_y_px,
                     .pixel_format = detector.pixel_format,
                     .packet_size_bytes = detector.packet_size_bytes},
          .settings = {.exposure = detector.shortest_exposure, .gain_db = detector.gain_db}};
}

}  // namespace

struct Devices::Impl {
  Impl(const Instrument& of, TapeDeck& deck)
      : instrument(of),
        stage_links(instrument),
        camera_link(camera_link_of(instrument.detector)),
        stage(deck.modbus(stage_links.motion(), TapeParty::Stage), instrument.stage, deck.clock(TapeParty::Stage)),
        halt_line(deck.modbus(stage_links.halts(), TapeParty::Halt, 0),
                  deck.modbus(stage_links.beats(), TapeParty::Halt, 1), instrument.stage.registers),
        engine_halt_line(deck.halt_line(halt_line)),
        camera(deck.camera(camera_link, TapeParty::Detector), camera_of(instrument.detector),
               deck.clock(TapeParty::Detector)) {}

  const Instrument instrument;
  StageLinks stage_links;
  drivers::AravisCameraLink camera_link;
  drivers::ModbusStage stage;
  drivers::ModbusHaltLine halt_line;
  drivers::HaltLine& engine_halt_line;  ///< the same, as the engine is to see it
  drivers::GenicamCamera camera;
};

Devices::Devices(const Instrument& instrument, TapeDeck& deck) : impl_(std::make_unique<Impl>(instrument, deck)) {}

Devices::~Devices() = default;

EngineDevices Devices::all() {
  return {.stage = impl_->stage, .detector = impl_->camera, .halt_line = impl_->engine_halt_line};
}

drivers::HaltLine& Devices::halt_line() {
  return impl_->halt_line;
}

}  // namespace gonio::daemon
