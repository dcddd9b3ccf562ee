#include "daemon/app/devices.h"

#include "daemon/app/stage_devices.h"
#include "drivers/genicam_camera/genicam_camera.h"
#include "drivers/links/aravis_camera_link.h"

namespace gonio::daemon {
namespace {

using drivers::TapeParty;

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
        stage(instrument, deck),
        camera_link(camera_link_of(instrument.detector)),
        engine_halt_line(deck.halt_line(stage.halt_line())),
        camera(deck.camera(camera_link, TapeParty::Detector), camera_of(instrument.detector),
               deck.clock(TapeParty::Detector)) {}

  const Instrument instrument;
  StageDevices stage;
  drivers::AravisCameraLink camera_link;
  drivers::HaltLine& engine_halt_line;  ///< the same, as the engine is to see it
  drivers::GenicamCamera camera;
};

Devices::Devices(const Instrument& instrument, TapeDeck& deck) : impl_(std::make_unique<Impl>(instrument, deck)) {}

Devices::~Devices() = default;

EngineDevices Devices::all() {
  return {.stage = impl_->stage.stage(), .detector = impl_->camera, .halt_line = impl_->engine_halt_line};
}

drivers::HaltLine& Devices::halt_line() {
  return impl_->stage.halt_line();
}

}  // namespace gonio::daemon
