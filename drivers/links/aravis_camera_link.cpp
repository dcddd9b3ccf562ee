// The adapter of Aravis: nothing else in this room knows it.
#include "drivers/links/aravis_camera_link.h"

#include <arv.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <utility>

namespace gonio::drivers {
namespace {

constexpr int kBuffers = 8;
constexpr int kSocketBufferBytes = 4 << 20;  // the kernel's default loses packets of bursts from 512 x 512 pixels on
constexpr Duration kControlRetry = std::chrono::milliseconds(250);

struct Unref {
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <class T>
using Owned = std::unique_ptr<T, Unref>;

// Collects the error that a call of Aravis leaves behind, and says it in our words.
class Outcome {
 public:
  Outcome() = default;
  Outcome(const Outcome&) = delete;
  Outcome& operator=(const Outcome&) = delete;
  ~Outcome() { g_clear_error(&error_); }

  GError** slot() {
    g_clear_error(&error_);
    return &error_;
  }
  [[nodiscard]] bool failed() const { return error_ != nullptr; }
  [[nodiscard]] Error as_error(std::string tried) const {
    return {.code = code(), .device = "detector", .tried = std::move(tried), .seen = error_->message};
  }

 private:
  [[nodiscard]] ErrorCode code() const {
    if (error_->domain != ARV_DEVICE_ERROR) return ErrorCode::DeviceRefused;
    switch (error_->code) {
      case ARV_DEVICE_ERROR_NOT_CONNECTED:
      case ARV_DEVICE_ERROR_TRANSFER_ERROR:
      case ARV_DEVICE_ERROR_TIMEOUT:
      case ARV_DEVICE_ERROR_NOT_FOUND:
        return ErrorCode::Unreachable;
      case ARV_DEVICE_ERROR_NOT_CONTROLLER:
      case ARV_DEVICE_ERROR_PROTOCOL_ERROR_ACCESS_DENIED:
        return ErrorCode::ControlLost;
      default:
        return ErrorCode::DeviceRefused;
    }
  }
  GError* error_ = nullptr;
};

// USB3Vision would start a libusb context and a thread of its own; Fake would answer for a camera that is not there.
void use_ethernet_only() {
  static std::once_flag once;
  std::call_once(once, [] {
    arv_disable_interface("USB3Vision");
    arv_disable_interface("Fake");
  });
}

// A bounded pause between two tries to get a camera that somebody still holds; nothing is waited for but time.
void pause(Duration time) {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable().wait_for(lock, time, [] { return false; });
}

bool is_address(const std::string& text) {
  const Owned<GInetAddress> address(g_inet_address_new_from_string(text.c_str()));
  return address != nullptr;
}

std::string status_text(ArvBufferStatus status) {
  switch (status) {
    case ARV_BUFFER_STATUS_TIMEOUT:
      return "packets missing when the wait for them ended";
    case ARV_BUFFER_STATUS_MISSING_PACKETS:
      return "packets missing";
    case ARV_BUFFER_STATUS_WRONG_PACKET_ID:
      return "a packet with a wrong id";
    case ARV_BUFFER_STATUS_SIZE_MISMATCH:
      return "an image that does not fit the buffer";
    case ARV_BUFFER_STATUS_ABORTED:
      return "reception aborted";
    default:
      return fmt::format("buffer status {}", static_cast<int>(status));
  }
}

int bytes_per_pixel(ArvPixelFormat format) {
  return ARV_PIXEL_FORMAT_BIT_PER_PIXEL(format) / 8;
}

// GigE Vision sends pixels of more than one byte low byte first, as this machine keeps them.
std::vector<std::uint16_t> pixels_of(const void* data, std::size_t count, int bytes) {
  std::vector<std::uint16_t> pixels(count);
  if (bytes == 2) {
    std::memcpy(pixels.data(), data, count * sizeof(std::uint16_t));
  } else {
    std::copy_n(static_cast<const std::uint8_t*>(data), count, pixels.begin());
  }
  return pixels;
}

CameraFrame frame_of(ArvBuffer* buffer) {
  CameraFrame frame;
  frame.frame_id = arv_buffer_get_frame_id(buffer);
  frame.camera_time_ns = arv_buffer_get_timestamp(buffer);
  const ArvBufferStatus status = arv_buffer_get_status(buffer);
  if (status != ARV_BUFFER_STATUS_SUCCESS) {
    frame.trouble = status_text(status);
    return frame;
  }
  frame.width = arv_buffer_get_image_width(buffer);
  frame.height = arv_buffer_get_image_height(buffer);
  const int bytes = bytes_per_pixel(arv_buffer_get_image_pixel_format(buffer));
  std::size_t size = 0;
  const void* data = arv_buffer_get_image_data(buffer, &size);
  const std::size_t count = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  if (bytes < 1 || bytes > 2 || size < count * static_cast<std::size_t>(bytes)) {
    frame.trouble = fmt::format("{} bytes for {} x {} pixels", size, frame.width, frame.height);
    return frame;
  }
  frame.pixels = pixels_of(data, count, bytes);
  frame.is_complete = true;
  return frame;
}

using Flag = std::shared_ptr<std::atomic<bool>>;

void on_control_lost(ArvDevice*, gpointer flag) {
  (*static_cast<Flag*>(flag))->store(true);
}
void drop_flag(gpointer flag, GClosure*) {
  delete static_cast<Flag*>(flag);
}

}  // namespace

struct AravisCameraLink::Impl {
  explicit Impl(AravisCameraConfig the_config) : config(std::move(the_config)) {}

  Error not_open(std::string tried) const {
    return {.code = ErrorCode::WrongState, .device = "detector", .tried = std::move(tried), .seen = "it is not open"};
  }

  // The state in which a call makes sense; asked first, because a call to a camera that is gone blocks for seconds.
  Result<void> ready(const std::string& tried) const {
    if (camera == nullptr) return failure(not_open(tried));
    if (!control_lost->load()) return {};
    return failure({.code = ErrorCode::ControlLost,
                    .device = "detector",
                    .tried = tried,
                    .seen = "another controller took the camera, or it fell silent"});
  }

  // Runs one call of Aravis that reports by GError.
  template <class Call>
  Result<void> run(const std::string& tried, Call call) {
    GONIO_TRY(ready(tried));
    Outcome outcome;
    call(outcome.slot());
    if (outcome.failed()) return failure(outcome.as_error(tried));
    return {};
  }

  Result<void> connect() {
    const std::string tried = fmt::format("open the camera at {}", config.address);
    Outcome outcome;
    camera.reset(arv_camera_new(config.address.c_str(), outcome.slot()));
    if (camera == nullptr) {
      Error error = outcome.failed() ? outcome.as_error(tried) : not_open(tried);
      error.code = ErrorCode::Unreachable;
      return failure(std::move(error));
    }
    ArvDevice* device = arv_camera_get_device(camera.get());
    if (!ARV_IS_GV_DEVICE(device)) {
      return failure(
          {.code = ErrorCode::WrongDevice, .device = "detector", .tried = tried, .seen = "not a GigE camera"});
    }
    control_lost = std::make_shared<std::atomic<bool>>(false);
    g_signal_connect_data(device, "control-lost", G_CALLBACK(on_control_lost), new Flag(control_lost), drop_flag,
                          GConnectFlags{});
    arv_camera_set_range_check_policy(camera.get(), ARV_RANGE_CHECK_POLICY_ENABLE);
    if (arv_gv_device_is_controller(ARV_GV_DEVICE(device))) return {};
    camera.reset();  // opening succeeds without control; writing would not
    return failure({.code = ErrorCode::ControlLost,
                    .device = "detector",
                    .tried = tried,
                    .seen = "another controller holds it",
                    .limit = fmt::format("waited {:.1f} s", in_seconds(config.control_wait))});
  }

  Result<DetectorIdentity> identity() {
    Outcome outcome;
    DetectorIdentity who;
    const auto take = [](std::string& into, const char* text) { into = text == nullptr ? "" : text; };
    take(who.vendor, arv_camera_get_vendor_name(camera.get(), outcome.slot()));
    if (!outcome.failed()) take(who.model, arv_camera_get_model_name(camera.get(), outcome.slot()));
    if (!outcome.failed()) take(who.serial, arv_camera_get_device_serial_number(camera.get(), outcome.slot()));
    if (outcome.failed()) return failure(outcome.as_error("read who it is"));
    return who;
  }

  Result<void> push_buffers() {
    Outcome outcome;
    const guint payload = arv_camera_get_payload(camera.get(), outcome.slot());
    if (outcome.failed()) return failure(outcome.as_error("read the size of a frame"));
    for (int i = 0; i < kBuffers; ++i) arv_stream_push_buffer(stream.get(), arv_buffer_new(payload, nullptr));
    return {};
  }

  AravisCameraConfig config;
  Flag control_lost = std::make_shared<std::atomic<bool>>(false);
  Owned<ArvCamera> camera;
  Owned<ArvStream> stream;
};

AravisCameraLink::AravisCameraLink(AravisCameraConfig config) : impl_(std::make_unique<Impl>(std::move(config))) {}
AravisCameraLink::~AravisCameraLink() {
  close();
}

Result<DetectorIdentity> AravisCameraLink::open() {
  close();
  use_ethernet_only();
  if (!is_address(impl_->config.address)) {  // anything else would be searched for by broadcast
    return failure({.code = ErrorCode::InvalidInput,
                    .device = "detector",
                    .tried = "open the camera",
                    .seen = fmt::format("address \"{}\"", impl_->config.address),
                    .limit = "four numbers such as 192.168.0.20"});
  }
  Result<void> connected = impl_->connect();
  for (Duration waited{};
       !connected && connected.error().code == ErrorCode::ControlLost && waited < impl_->config.control_wait;
       waited += kControlRetry) {
    pause(kControlRetry);
    connected = impl_->connect();
  }
  if (connected) return impl_->identity();
  impl_->camera.reset();
  return failure(std::move(connected).error());
}

void AravisCameraLink::close() {
  stop();
  impl_->camera.reset();
}

bool AravisCameraLink::is_open() const {
  return impl_->camera != nullptr;
}
bool AravisCameraLink::has_lost_control() const {
  return impl_->control_lost->load();
}
bool AravisCameraLink::is_streaming() const {
  return impl_->stream != nullptr;
}

Result<void> AravisCameraLink::set_format(const CameraFormat& format) {
  ArvCamera* camera = impl_->camera.get();
  GONIO_TRY(impl_->run(fmt::format("set the pixel format {}", format.pixel_format), [&](GError** e) {
    arv_camera_set_pixel_format_from_string(camera, format.pixel_format.c_str(), e);
  }));
  GONIO_TRY(impl_->run(fmt::format("set the region {} x {} px", format.width, format.height),
                       [&](GError** e) { arv_camera_set_region(camera, 0, 0, format.width, format.height, e); }));
  return impl_->run(fmt::format("set packets of {} bytes", format.packet_size_bytes),
                    [&](GError** e) { arv_camera_gv_set_packet_size(camera, format.packet_size_bytes, e); });
}

Result<CameraFormat> AravisCameraLink::format() {
  ArvCamera* camera = impl_->camera.get();
  CameraFormat format;
  GONIO_TRY(impl_->run("read the region", [&](GError** e) {
    int x = 0;
    int y = 0;
    arv_camera_get_region(camera, &x, &y, &format.width, &format.height, e);
  }));
  GONIO_TRY(impl_->run("read the pixel format", [&](GError** e) {
    const char* name = arv_camera_get_pixel_format_as_string(camera, e);
    format.pixel_format = name == nullptr ? "" : name;
  }));
  GONIO_TRY(impl_->run("read the packet size", [&](GError** e) {
    format.packet_size_bytes = static_cast<int>(arv_camera_gv_get_packet_size(camera, e));
  }));
  return format;
}

Result<void> AravisCameraLink::set_exposure(const ExposureSettings& settings) {
  ArvCamera* camera = impl_->camera.get();
  const double exposure_us = in_seconds(settings.exposure) * 1e6;
  GONIO_TRY(impl_->run(fmt::format("set the exposure {} us", exposure_us),
                       [&](GError** e) { arv_camera_set_exposure_time(camera, exposure_us, e); }));
  return impl_->run(fmt::format("set the gain {} dB", settings.gain_db),
                    [&](GError** e) { arv_camera_set_gain(camera, settings.gain_db, e); });
}

Result<ExposureSettings> AravisCameraLink::exposure() {
  ArvCamera* camera = impl_->camera.get();
  double exposure_us = 0.0;
  ExposureSettings settings;
  GONIO_TRY(
      impl_->run("read the exposure", [&](GError** e) { exposure_us = arv_camera_get_exposure_time(camera, e); }));
  GONIO_TRY(impl_->run("read the gain", [&](GError** e) { settings.gain_db = arv_camera_get_gain(camera, e); }));
  settings.exposure = std::chrono::round<Duration>(std::chrono::duration<double, std::micro>(exposure_us));
  return settings;
}

Result<double> AravisCameraLink::temperature_c() {
  double temperature = 0.0;
  GONIO_TRY(impl_->run("read the temperature", [&](GError** e) {
    temperature = arv_camera_get_float(impl_->camera.get(), "DeviceTemperature", e);
  }));
  return temperature;
}

Result<void> AravisCameraLink::start() {
  stop();
  ArvCamera* camera = impl_->camera.get();
  GONIO_TRY(impl_->run("set the software trigger", [&](GError** e) { arv_camera_set_trigger(camera, "Software", e); }));
  // Plain UDP whether root or not: the packet socket is 5 ms slower and would make two kinds of installation differ.
  arv_camera_gv_set_stream_options(camera, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
  GONIO_TRY(impl_->run("make the stream", [&](GError** e) {
    impl_->stream.reset(arv_camera_create_stream(camera, nullptr, nullptr, e));
  }));
  if (impl_->stream == nullptr) return failure(impl_->not_open("make the stream"));
  g_object_set(impl_->stream.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
               kSocketBufferBytes, nullptr);
  Result<void> started = impl_->push_buffers();
  if (started) started = impl_->run("start", [&](GError** e) { arv_camera_start_acquisition(camera, e); });
  if (!started) impl_->stream.reset();
  return started;
}

void AravisCameraLink::stop() {
  if (impl_->stream == nullptr) return;
  // A camera that is lost would let this call wait for 2.5 s; its stream ends with the control channel anyway.
  if (impl_->camera != nullptr && !has_lost_control()) {
    Outcome ignored;
    arv_camera_stop_acquisition(impl_->camera.get(), ignored.slot());
  }
  impl_->stream.reset();
}

Result<void> AravisCameraLink::trigger() {
  return impl_->run("trigger", [&](GError** e) { arv_camera_software_trigger(impl_->camera.get(), e); });
}

Result<std::optional<CameraFrame>> AravisCameraLink::pop(Duration wait) {
  if (impl_->stream == nullptr) return failure(impl_->not_open("fetch a frame"));
  const auto wait_us = std::chrono::ceil<std::chrono::microseconds>(wait).count();
  ArvBuffer* buffer = wait_us > 0 ? arv_stream_timeout_pop_buffer(impl_->stream.get(), static_cast<guint64>(wait_us))
                                  : arv_stream_try_pop_buffer(impl_->stream.get());
  if (buffer == nullptr) {
    GONIO_TRY(impl_->ready("fetch a frame"));
    return std::optional<CameraFrame>();
  }
  CameraFrame frame = frame_of(buffer);
  arv_stream_push_buffer(impl_->stream.get(), buffer);
  return std::optional<CameraFrame>(std::move(frame));
}

}  // namespace gonio::drivers
