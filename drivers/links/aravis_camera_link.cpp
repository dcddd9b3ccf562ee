// The adapter of Aravis: nothing else in this room knows it.
#include "drivers/links/aravis_camera_link.h"

#include <arv.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <initializer_list>
#include <mutex>
#include <string_view>
#include <utility>

#include "drivers/links/pixel_unpacking.h"

namespace gonio::drivers {
namespace {

constexpr int kBuffers = 8;
constexpr int kSocketBufferBytes = 4 << 20;  // the kernel's default loses packets of bursts from 512 x 512 pixels on
constexpr unsigned kPacketHeaders = 20 + 8 + 8;  // IP, UDP, GVSP: they count in the packet size
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
    Error error{.code = code(), .device = "detector", .tried = std::move(tried), .seen = error_->message};
    if (error.code == ErrorCode::ControlLost) error.seen = "another controller has the camera";
    return error;
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

// Fake would answer for a camera that is not there; USB3Vision starts a libusb context and a thread of its own, and
// GigEVision broadcasts: neither without need.
void use_only(CameraTransport transport) {
  const bool is_usb = transport == CameraTransport::Usb3;
  arv_disable_interface("Fake");
  arv_disable_interface(is_usb ? "GigEVision" : "USB3Vision");
  arv_enable_interface(is_usb ? "USB3Vision" : "GigEVision");
}

// A bounded pause between two tries to get a camera that somebody still holds; nothing is waited for but time.
void pause(Duration time) {
  std::mutex mutex;
  std::unique_lock lock(mutex);
  std::condition_variable().wait_for(lock, time, [] { return false; });
}

std::string text_of(const char* text) {
  return text == nullptr ? "" : text;
}

// What arv_camera_new opens: the address of a GigE camera, the id of one on USB.
std::string handle_of(unsigned device, CameraTransport transport) {
  return text_of(transport == CameraTransport::Gige ? arv_get_device_address(device) : arv_get_device_id(device));
}

/// The handle of the one camera with this serial number. Broadcasts; takes a second.
Result<std::string> find_by_serial(const std::string& serial, CameraTransport transport) {
  arv_update_device_list();
  std::string handle;
  std::string seen;
  int matches = 0;
  for (unsigned k = 0; k < arv_get_n_devices(); ++k) {
    const std::string other = text_of(arv_get_device_serial_nbr(k));
    seen += fmt::format("{}{} at {}", seen.empty() ? "" : ", ", other, handle_of(k, transport));
    if (other != serial) continue;
    ++matches;
    handle = handle_of(k, transport);
  }
  if (matches == 1) return handle;
  return failure({.code = matches == 0 ? ErrorCode::Unreachable : ErrorCode::WrongDevice,
                  .device = "detector",
                  .tried = fmt::format("find the camera with serial number {}", serial),
                  .seen = seen.empty() ? "no camera" : seen,
                  .limit = "one that has it"});
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

/// What came of a stream so far. Aravis counts a frame's missing packets from the first gap to the end, so they are
/// told from those that came.
struct PacketCount {
  std::uint64_t received = 0;
  std::uint64_t duplicated = 0;
};

PacketCount packets_of(ArvStream* stream) {
  return {.received = arv_stream_get_info_uint64_by_name(stream, "n_received_packets"),
          .duplicated = arv_stream_get_info_uint64_by_name(stream, "n_duplicated_packets")};
}

std::string missing_text(std::uint64_t packets_a_frame, const PacketCount& before, const PacketCount& now) {
  if (packets_a_frame == 0) return "";  // a link without packets
  const std::uint64_t came = (now.received - before.received) - (now.duplicated - before.duplicated);
  return fmt::format(": {} of {} packets did not come", packets_a_frame - std::min(came, packets_a_frame),
                     packets_a_frame);
}

// A buffer that is whole, with its pixels unpacked. Chunks behind the image count in its size, so that only the least
// is checked; padding of lines is not part of what any of our formats' cameras send.
void take_image(ArvBuffer* buffer, CameraFrame& frame) {
  frame.width = arv_buffer_get_image_width(buffer);
  frame.height = arv_buffer_get_image_height(buffer);
  const std::uint32_t code = arv_buffer_get_image_pixel_format(buffer);
  const auto format = pixel_format_of_code(code);
  if (!format) {
    frame.trouble = fmt::format("pixels of format 0x{:08X}", code);
    return;
  }
  std::size_t size = 0;
  const void* data = arv_buffer_get_image_data(buffer, &size);
  const std::size_t count = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  if (size < packed_size(*format, count)) {
    frame.trouble = fmt::format("{} bytes for {} x {} pixels of {}", size, frame.width, frame.height, format->name);
    return;
  }
  int pad_x = 0;
  int pad_y = 0;
  arv_buffer_get_image_padding(buffer, &pad_x, &pad_y);
  if (pad_x != 0) {
    frame.trouble = fmt::format("lines padded by {} bytes", pad_x);
    return;
  }
  frame.pixels = unpack(*format, {static_cast<const std::uint8_t*>(data), size}, count);
  frame.is_complete = true;
}

CameraFrame frame_of(ArvBuffer* buffer, const std::string& missing) {
  CameraFrame frame;
  frame.frame_id = arv_buffer_get_frame_id(buffer);
  frame.camera_time_ns = arv_buffer_get_timestamp(buffer);  // Aravis has turned ticks into ns
  const ArvBufferStatus status = arv_buffer_get_status(buffer);
  if (status == ARV_BUFFER_STATUS_SUCCESS)
    take_image(buffer, frame);
  else
    frame.trouble = status_text(status) + missing;
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

  // What arv_camera_new opens.
  Result<std::string> find_camera() const {
    if (config.address.empty() && !config.serial.empty()) return find_by_serial(config.serial, config.transport);
    if (config.transport == CameraTransport::Gige && is_address(config.address)) return config.address;
    return failure({.code = ErrorCode::InvalidInput,  // anything else would be searched for by broadcast
                    .device = "detector",
                    .tried = "open the camera",
                    .seen = fmt::format("address \"{}\", serial \"{}\"", config.address, config.serial),
                    .limit = "an address of four numbers such as 192.168.0.20 (GigE), or none and a serial number"});
  }

  Result<void> connect(const std::string& handle) {
    const std::string tried = fmt::format("open the camera at {}", handle);
    Outcome outcome;
    camera.reset(arv_camera_new(handle.c_str(), outcome.slot()));
    if (camera == nullptr) {
      Error error = outcome.failed() ? outcome.as_error(tried) : not_open(tried);
      error.code = ErrorCode::Unreachable;
      return failure(std::move(error));
    }
    ArvDevice* device = arv_camera_get_device(camera.get());
    is_gige = arv_camera_is_gv_device(camera.get()) != FALSE;
    control_lost = std::make_shared<std::atomic<bool>>(false);
    g_signal_connect_data(device, "control-lost", G_CALLBACK(on_control_lost), new Flag(control_lost), drop_flag,
                          GConnectFlags{});
    arv_camera_set_range_check_policy(camera.get(), ARV_RANGE_CHECK_POLICY_ENABLE);
    if (!is_gige || arv_gv_device_is_controller(ARV_GV_DEVICE(device))) return {};
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
    const auto take = [](std::string& into, const char* text) { into = text_of(text); };
    take(who.vendor, arv_camera_get_vendor_name(camera.get(), outcome.slot()));
    if (!outcome.failed()) take(who.model, arv_camera_get_model_name(camera.get(), outcome.slot()));
    if (!outcome.failed()) take(who.serial, arv_camera_get_device_serial_number(camera.get(), outcome.slot()));
    if (outcome.failed()) return failure(outcome.as_error("read who it is"));
    return who;
  }

  bool has(const char* feature) {
    Outcome ignored;
    return arv_camera_is_feature_available(camera.get(), feature, ignored.slot()) != FALSE;
  }

  /// The first of these names that the camera knows.
  Result<const char*> feature(const std::string& tried, std::initializer_list<const char*> names) {
    GONIO_TRY(ready(tried));
    for (const char* name : names) {
      if (has(name)) return name;
    }
    return failure({.code = ErrorCode::DeviceRefused,
                    .device = "detector",
                    .tried = tried,
                    .seen = "no such feature",
                    .limit = fmt::format("one of {}", fmt::join(names, ", "))});
  }

  /// What would change settings behind our back.
  Result<void> switch_automatics_off() {
    for (const char* name : {"ExposureAuto", "GainAuto"}) {
      if (!has(name)) continue;
      GONIO_TRY(run(fmt::format("switch {} off", name),
                    [&](GError** e) { arv_camera_set_string(camera.get(), name, "Off", e); }));
    }
    for (const char* name : {"AcquisitionFrameRateEnable", "AcquisitionFrameRateEnabled"}) {
      if (!has(name)) continue;
      GONIO_TRY(run(fmt::format("switch {} off", name),
                    [&](GError** e) { arv_camera_set_boolean(camera.get(), name, FALSE, e); }));
    }
    return {};
  }

  Result<void> set_gain(double gain_db) {
    const std::string tried = fmt::format("set the gain {} dB", gain_db);
    const auto name = feature(tried, {"Gain", "GainAbs", "GainRaw"});
    if (!name) return failure(name.error());
    if (std::string_view(*name) != "GainRaw")
      return run(tried, [&](GError** e) { arv_camera_set_float(camera.get(), *name, gain_db, e); });
    if (gain_db != 0.0) {
      return failure({.code = ErrorCode::DeviceRefused,
                      .device = "detector",
                      .tried = tried,
                      .seen = "a gain in the maker's own steps (GainRaw)",
                      .limit = "0 dB: its lowest step"});
    }
    const auto lowest = lowest_raw_gain();
    if (!lowest) return failure(lowest.error());
    return run(tried, [&](GError** e) { arv_camera_set_integer(camera.get(), *name, *lowest, e); });
  }

  Result<gint64> lowest_raw_gain() {
    gint64 least = 0;
    gint64 most = 0;
    GONIO_TRY(run("read the range of GainRaw",
                  [&](GError** e) { arv_camera_get_integer_bounds(camera.get(), "GainRaw", &least, &most, e); }));
    return least;
  }

  Result<double> gain_db() {
    const auto name = feature("read the gain", {"Gain", "GainAbs", "GainRaw"});
    if (!name) return failure(name.error());
    double gain = 0.0;
    if (std::string_view(*name) != "GainRaw") {
      GONIO_TRY(run("read the gain", [&](GError** e) { gain = arv_camera_get_float(camera.get(), *name, e); }));
      return gain;
    }
    const auto lowest = lowest_raw_gain();
    if (!lowest) return failure(lowest.error());
    gint64 raw = 0;
    GONIO_TRY(run("read the gain", [&](GError** e) { raw = arv_camera_get_integer(camera.get(), *name, e); }));
    if (raw == *lowest) return 0.0;
    return failure({.code = ErrorCode::SettingNotTaken,
                    .device = "detector",
                    .tried = "read the gain",
                    .seen = fmt::format("GainRaw {}", raw),
                    .limit = fmt::format("{}: its lowest step, 0 dB", *lowest)});
  }

  Result<void> push_buffers() {
    Outcome outcome;
    const guint payload = arv_camera_get_payload(camera.get(), outcome.slot());
    if (outcome.failed()) return failure(outcome.as_error("read the size of a frame"));
    for (int i = 0; i < kBuffers; ++i) arv_stream_push_buffer(stream.get(), arv_buffer_new(payload, nullptr));
    packets_a_frame = 0;
    if (!is_gige) return {};
    const guint packet = arv_camera_gv_get_packet_size(camera.get(), outcome.slot());
    if (outcome.failed()) return failure(outcome.as_error("read the packet size"));
    if (packet > kPacketHeaders) {
      const guint data = packet - kPacketHeaders;
      packets_a_frame = (payload + data - 1) / data + 2;  // leader and trailer
    }
    return {};
  }

  void count_from_here() {
    if (packets_a_frame > 0 && stream != nullptr) packets_before = packets_of(stream.get());
  }

  AravisCameraConfig config;
  Flag control_lost = std::make_shared<std::atomic<bool>>(false);
  Owned<ArvCamera> camera;
  Owned<ArvStream> stream;
  bool is_gige = true;
  std::uint64_t packets_a_frame = 0;
  PacketCount packets_before;  ///< the last trigger
};

AravisCameraLink::AravisCameraLink(AravisCameraConfig config) : impl_(std::make_unique<Impl>(std::move(config))) {}
AravisCameraLink::~AravisCameraLink() {
  close();
}

Result<DetectorIdentity> AravisCameraLink::open() {
  close();
  use_only(impl_->config.transport);
  const Result<std::string> handle = impl_->find_camera();
  if (!handle) return failure(handle.error());
  Result<void> connected = impl_->connect(*handle);
  for (Duration waited{};
       !connected && connected.error().code == ErrorCode::ControlLost && waited < impl_->config.control_wait;
       waited += kControlRetry) {
    pause(kControlRetry);
    connected = impl_->connect(*handle);
  }
  if (connected) connected = impl_->switch_automatics_off();
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
  GONIO_TRY(impl_->run(fmt::format("set the region {} x {} px from ({}, {})", format.width, format.height,
                                   format.offset_x, format.offset_y),
                       [&](GError** e) {
                         arv_camera_set_region(camera, format.offset_x, format.offset_y, format.width, format.height,
                                               e);
                       }));
  if (!impl_->is_gige) return {};
  return impl_->run(fmt::format("set packets of {} bytes", format.packet_size_bytes),
                    [&](GError** e) { arv_camera_gv_set_packet_size(camera, format.packet_size_bytes, e); });
}

Result<CameraFormat> AravisCameraLink::format() {
  ArvCamera* camera = impl_->camera.get();
  CameraFormat format;
  GONIO_TRY(impl_->run("read the region", [&](GError** e) {
    arv_camera_get_region(camera, &format.offset_x, &format.offset_y, &format.width, &format.height, e);
  }));
  GONIO_TRY(impl_->run("read the pixel format", [&](GError** e) {
    const char* name = arv_camera_get_pixel_format_as_string(camera, e);
    format.pixel_format = text_of(name);
  }));
  if (!impl_->is_gige) return format;
  GONIO_TRY(impl_->run("read the packet size", [&](GError** e) {
    format.packet_size_bytes = static_cast<int>(arv_camera_gv_get_packet_size(camera, e));
  }));
  return format;
}

Result<void> AravisCameraLink::set_exposure(const ExposureSettings& settings) {
  ArvCamera* camera = impl_->camera.get();
  const double exposure_us = in_seconds(settings.exposure) * 1e6;
  const std::string tried = fmt::format("set the exposure {} us", exposure_us);
  const auto name = impl_->feature(tried, {"ExposureTime", "ExposureTimeAbs"});
  if (!name) return failure(name.error());
  GONIO_TRY(impl_->run(tried, [&](GError** e) { arv_camera_set_float(camera, *name, exposure_us, e); }));
  return impl_->set_gain(settings.gain_db);
}

Result<ExposureSettings> AravisCameraLink::exposure() {
  ArvCamera* camera = impl_->camera.get();
  double exposure_us = 0.0;
  const auto name = impl_->feature("read the exposure", {"ExposureTime", "ExposureTimeAbs"});
  if (!name) return failure(name.error());
  GONIO_TRY(impl_->run("read the exposure", [&](GError** e) { exposure_us = arv_camera_get_float(camera, *name, e); }));
  const auto gain_db = impl_->gain_db();
  if (!gain_db) return failure(gain_db.error());
  ExposureSettings settings{.exposure = {}, .gain_db = *gain_db};
  settings.exposure = std::chrono::round<Duration>(std::chrono::duration<double, std::micro>(exposure_us));
  return settings;
}

Result<std::optional<double>> AravisCameraLink::temperature_c() {
  const std::string tried = "read the temperature";
  GONIO_TRY(impl_->ready(tried));
  for (const char* name : {"DeviceTemperature", "DeviceTemperatureAbs"}) {
    if (!impl_->has(name)) continue;
    double temperature = 0.0;
    GONIO_TRY(impl_->run(tried, [&](GError** e) { temperature = arv_camera_get_float(impl_->camera.get(), name, e); }));
    return std::optional(temperature);
  }
  return std::optional<double>();
}

Result<void> AravisCameraLink::start() {
  stop();
  ArvCamera* camera = impl_->camera.get();
  GONIO_TRY(impl_->run("set the software trigger", [&](GError** e) { arv_camera_set_trigger(camera, "Software", e); }));
  if (impl_->is_gige) {
    // Plain UDP whether root or not: the packet socket is 5 ms slower and would make two kinds of installation differ.
    arv_camera_gv_set_stream_options(camera, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
    arv_camera_gv_set_packet_size_adjustment(camera, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
  }
  GONIO_TRY(impl_->run("make the stream", [&](GError** e) {
    impl_->stream.reset(arv_camera_create_stream(camera, nullptr, nullptr, e));
  }));
  if (impl_->stream == nullptr) return failure(impl_->not_open("make the stream"));
  if (impl_->is_gige) {
    g_object_set(impl_->stream.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
                 kSocketBufferBytes, nullptr);
  }
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
  impl_->count_from_here();
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
  const std::uint64_t packets = impl_->packets_a_frame;
  const PacketCount now = packets > 0 ? packets_of(impl_->stream.get()) : PacketCount{};
  CameraFrame frame = frame_of(buffer, missing_text(packets, impl_->packets_before, now));
  arv_stream_push_buffer(impl_->stream.get(), buffer);
  return std::optional<CameraFrame>(std::move(frame));
}

}  // namespace gonio::drivers
