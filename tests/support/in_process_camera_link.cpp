#include "tests/support/in_process_camera_link.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace gonio::test {
namespace {

using Parts = sim::LiveInstrument::Parts;

std::vector<std::uint16_t> region_of(const sim::CameraFrame& frame, const drivers::CameraFormat& format) {
  std::vector<std::uint16_t> pixels;
  for (int y = format.offset_y; y < format.offset_y + format.height; ++y) {
    const auto row = frame.pixels.begin() + std::ptrdiff_t{y} * frame.width + format.offset_x;
    pixels.insert(pixels.end(), row, row + format.width);
  }
  return pixels;
}

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
  const sim::DetectorSpec& sensor = instrument_.scene().detector;
  drivers::CameraFormat format = format_;
  format.width = std::min(format.width, sensor.width_px - format.offset_x);
  format.height = std::min(format.height, sensor.height_px - format.offset_y);
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
  return instrument_.with([](Parts& parts) {
    const bool has_one = parts.instrument.scene().detector.has_temperature;
    return has_one ? std::optional(in_celsius(parts.camera.temperature(parts.now))) : std::nullopt;
  });
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
      .width = format_.width,
      .height = format_.height,
      .pixels = region_of(*ready_frame, format_),
      .frame_id = ready_frame->frame_id,
      .camera_time_ns = static_cast<std::uint64_t>(ready_frame->exposure_end.time_since_epoch().count())});
}

}  // namespace gonio::test
