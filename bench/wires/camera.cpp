// Trigger to frame: our driver on its link, and Aravis bare, on the same simulated camera.
#include <arv.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <string>

#include "bench/wires/bench_scene.h"
#include "bench/wires/contest.h"
#include "bench/wires/contests.h"
#include "drivers/genicam_camera/genicam_camera.h"
#include "drivers/links/aravis_camera_link.h"
#include "sim/wires/gige_camera_server.h"

namespace gonio::bench {
namespace {

using namespace std::chrono_literals;

constexpr double kExposureUs = 100.0;
constexpr int kPacketBytes = 8000;
constexpr int kBuffers = 8;
constexpr guint64 kPatienceUs = 2'000'000;

struct Size {
  int side_px;
  int frames;  // of a stretch
};

// An address of this process alone: the port of GigE Vision is fixed.
std::string own_address() {
  const auto process = static_cast<unsigned>(::getpid());
  return fmt::format("127.211.{}.{}", process >> 8U & 0xFFU, 1 + process % 250);
}

double our_rate(const std::string& address, const Size& size) {
  const SystemClock clock;
  drivers::AravisCameraLink link({.address = address});
  const drivers::CameraFormat format{
      .width = size.side_px, .height = size.side_px, .pixel_format = "Mono12", .packet_size_bytes = kPacketBytes};
  drivers::GenicamCamera camera(
      link, {.serial = "SIM-0001", .format = format, .settings = {.exposure = 100us, .gain_db = 0.0}}, clock);
  return per_second(size.frames, [&] {
    if (!camera.trigger()) return false;
    const auto frame = camera.collect(2s);
    return frame && frame->has_value();
  });
}

// GLib's objects and errors, let go at the end.
template <class T>
struct Unref {
  void operator()(T* object) const { g_object_unref(object); }
};
using Camera = std::unique_ptr<ArvCamera, Unref<ArvCamera>>;
using Stream = std::unique_ptr<ArvStream, Unref<ArvStream>>;

class Trouble {
 public:
  Trouble() = default;
  Trouble(const Trouble&) = delete;
  Trouble& operator=(const Trouble&) = delete;
  ~Trouble() { g_clear_error(&error_); }
  GError** out() {
    g_clear_error(&error_);
    return &error_;
  }
  [[nodiscard]] bool is_none() const { return error_ == nullptr; }

 private:
  GError* error_ = nullptr;
};

Camera open_bare(const std::string& address, const Size& size) {
  Trouble trouble;
  Camera camera(arv_camera_new(address.c_str(), trouble.out()));
  if (camera == nullptr) return nullptr;
  // As our link: the same path for packets whoever runs it.
  arv_gv_device_set_stream_options(ARV_GV_DEVICE(arv_camera_get_device(camera.get())),
                                   ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
  arv_camera_set_region(camera.get(), 0, 0, size.side_px, size.side_px, trouble.out());
  arv_camera_gv_set_packet_size(camera.get(), kPacketBytes, trouble.out());
  arv_camera_set_exposure_time(camera.get(), kExposureUs, trouble.out());
  arv_camera_set_trigger(camera.get(), "Software", trouble.out());
  return trouble.is_none() ? std::move(camera) : nullptr;
}

Stream stream_of(const Camera& camera) {
  Trouble trouble;
  Stream stream(arv_camera_create_stream(camera.get(), nullptr, nullptr, trouble.out()));
  if (stream == nullptr) return nullptr;
  g_object_set(stream.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size", 4 << 20,
               nullptr);
  const guint payload = arv_camera_get_payload(camera.get(), trouble.out());
  for (int k = 0; k < kBuffers; ++k) arv_stream_push_buffer(stream.get(), arv_buffer_new(payload, nullptr));
  return stream;
}

bool bare_frame(const Camera& camera, const Stream& stream) {
  Trouble trouble;
  arv_camera_software_trigger(camera.get(), trouble.out());
  ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream.get(), kPatienceUs);
  if (buffer == nullptr) return false;
  const bool is_whole = arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS;
  arv_stream_push_buffer(stream.get(), buffer);
  return is_whole && trouble.is_none();
}

double bare_rate(const std::string& address, const Size& size) {
  const Camera camera = open_bare(address, size);
  if (camera == nullptr) return 0.0;
  const Stream stream = stream_of(camera);
  if (stream == nullptr) return 0.0;
  Trouble trouble;
  arv_camera_start_acquisition(camera.get(), trouble.out());
  const double rate = per_second(size.frames, [&] { return bare_frame(camera, stream); });
  arv_camera_stop_acquisition(camera.get(), trouble.out());
  return rate;
}

}  // namespace

bool hold_camera(int rounds) {
  const SystemClock clock;
  const std::string address = own_address();
  bool all = true;
  for (const Size size : {Size{64, 200}, Size{512, 40}, Size{1024, 15}}) {
    sim::LiveInstrument instrument(bench_scene(size.side_px), {}, clock);
    const auto server = sim::GigeCameraServer::start(instrument, address);
    if (!server) return false;
    all = hold({.what = fmt::format("camera, GigE Vision, {0} x {0} Mono12, 0.1 ms", size.side_px),
                .ours = [&] { return our_rate(address, size); },
                .bare = [&] { return bare_rate(address, size); }},
               rounds) &&
          all;
  }
  return all;
}

}  // namespace gonio::bench
