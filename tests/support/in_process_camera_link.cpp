#include "tests/support/in_process_camera_link.h"

#include <utility>

namespace gonio::test {
namespace {

using Parts = sim::LiveInstrument::Parts;

}  // namespace

Result<void> InProcessCameraLink::ready() const {
  if (broken_) return failure(*broken_);
  if (is_open_) return {};
  return failure({.code = ErrorCode::WrongState, .device = "detector", .tried = "talk", .seen = "it is not open"});
}

Result<drivers::DetectorIdentity> InProcessCameraLink::open() {
  close();
  if (broken_) return failure(*broken_);
  is_open_ = true;
  return drivers::DetectorIdentity{"Goniod", "simulated", instrument_.scene().detector.serial};
}

Result<void> InProcessCameraLink::set_format(const drivers::CameraFormat& format) {
  GONIO_TRY(ready());
  format_ = format;
  return {};
}

Result<drivers::CameraFormat> InProcessCameraLink::format() {
  GONIO_TRY(ready());
  drivers::CameraFormat format = format_;
  format.width = instrument_.scene().detector.width_px;
  format.height = instrument_.scene().detector.height_px;
  return format;
}

Result<void> InProcessCameraLink::set_exposure(const drivers::ExposureSettings& settings) {
  GONIO_TRY(ready());
  return instrument_.with([&](Parts& parts) -> Result<void> {
    GONIO_TRY(parts.camera.set_exposure(settings.exposure));
    return parts.camera.set_gain(settings.gain_db);
  });
}

Result<drivers::ExposureSettings> InProcessCameraLink::exposure() {
  GONIO_TRY(ready());
  return instrument_.with([](Parts& parts) {
    return drivers::ExposureSettings{parts.camera.exposure(), parts.camera.gain_db()};
  });
}

Result<std::optional<double>> InProcessCameraLink::temperature_c() {
  GONIO_TRY(ready());
  return instrument_.with([](Parts& parts) { return std::optional(in_celsius(parts.camera.temperature(parts.now))); });
}

Result<void> InProcessCameraLink::start() {
  GONIO_TRY(ready());
  instrument_.with([](Parts& parts) {
    static_cast<void>(parts.camera.collect_exposure(parts.now));  // of an acquisition before
    parts.camera.restart_frame_ids();
  });
  is_streaming_ = true;
  return {};
}

Result<void> InProcessCameraLink::trigger() {
  GONIO_TRY(ready());
  instrument_.with([](Parts& parts) { static_cast<void>(parts.camera.trigger(parts.now)); });
  return {};
}

Result<std::optional<drivers::CameraFrame>> InProcessCameraLink::pop(Duration) {
  GONIO_TRY(ready());
  std::optional<sim::CameraFrame> ready_frame =
      instrument_.with([](Parts& parts) { return parts.camera.collect(parts.now); });
  if (!ready_frame) return std::optional<drivers::CameraFrame>();
  return std::optional<drivers::CameraFrame>(drivers::CameraFrame{
      .is_complete = true,
      .trouble = {},
      .width = ready_frame->width,
      .height = ready_frame->height,
      .pixels = std::move(ready_frame->pixels),
      .frame_id = ready_frame->frame_id,
      .camera_time_ns = static_cast<std::uint64_t>(ready_frame->exposure_end.time_since_epoch().count())});
}

}  // namespace gonio::test
