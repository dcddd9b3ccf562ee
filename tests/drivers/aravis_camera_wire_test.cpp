// The camera driver and Aravis against the simulator's camera, over UDP on a loopback address of this process' own: the
// port is fixed, and tests run in parallel.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <numeric>

#include "drivers/genicam_camera/genicam_camera.h"
#include "drivers/links/aravis_camera_link.h"
#include "sim/scene/read_scene.h"
#include "sim/wires/gige_camera_server.h"

namespace gonio::drivers {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

sim::Scene scene() {
  auto read = sim::read_scene(GONIO_SCENE_DIR "/lambertian.toml");
  EXPECT_TRUE(read) << describe(read.error());
  return std::move(*read);
}

std::string own_address() {
  const auto id = static_cast<unsigned>(getpid());
  const unsigned high = 64U + ((id >> 16U) & 63U);
  return "127." + std::to_string(high) + "." + std::to_string((id >> 8U) & 255U) + "." + std::to_string(id & 255U);
}

/// One simulated camera, with closed shutters: its frames show the dark.
class AravisCameraWire : public testing::Test {
 protected:
  void serve() {
    auto started = sim::GigeCameraServer::start(instrument, address);
    ASSERT_TRUE(started) << describe(started.error());
    server = std::move(*started);
  }

  GenicamCameraConfig config() const {
    const sim::DetectorSpec& detector = instrument.scene().detector;
    return {.serial = detector.serial,
            .format = {.width = detector.width_px,
                       .height = detector.height_px,
                       .pixel_format = "Mono12",
                       .packet_size_bytes = 1400},
            .settings = {.exposure = 2ms, .gain_db = 0.0}};
  }

  /// The frame of one trigger, however slow the machine.
  static Result<Frame> take(GenicamCamera& camera) {
    if (auto triggered = camera.trigger(); !triggered) return failure(triggered.error());
    for (;;) {
      auto collected = camera.collect(100ms);
      if (!collected) return failure(collected.error());
      if (*collected) return std::move(**collected);
    }
  }

  SystemClock clock;
  sim::LiveInstrument instrument{scene(), {}, clock};
  std::string address = own_address();
  std::unique_ptr<sim::GigeCameraServer> server;
};

TEST_F(AravisCameraWire, TakesFramesOneATrigger) {
  serve();
  AravisCameraLink link({.address = address});
  GenicamCamera camera(link, config(), clock);

  const auto first = take(camera);
  const auto second = take(camera);

  ASSERT_TRUE(first) << describe(first.error());
  ASSERT_TRUE(second) << describe(second.error());
  EXPECT_EQ(second->frame_id, first->frame_id + 1);
  EXPECT_EQ(first->settings, config().settings);
  ASSERT_EQ(first->pixels.size(), 64U * 64U);
  const double mean = std::accumulate(first->pixels.begin(), first->pixels.end(), 0.0) / (64.0 * 64.0);
  EXPECT_NEAR(mean, instrument.scene().detector.offset_dn, 2.0);  // dark current is below 1 DN, noise of the mean 0.03
}

TEST_F(AravisCameraWire, ReadsBackWhatItWrote) {
  serve();
  AravisCameraLink link({.address = address});
  ASSERT_TRUE(link.open());

  ASSERT_TRUE(link.set_format(config().format));
  ASSERT_TRUE(link.set_exposure({.exposure = 3ms, .gain_db = 6.0}));

  const auto format = link.format();
  const auto exposure = link.exposure();
  ASSERT_TRUE(format && exposure);
  EXPECT_EQ(*format, config().format);
  EXPECT_EQ(*exposure, (ExposureSettings{3ms, 6.0}));
}

TEST_F(AravisCameraWire, RefusesAnExposureOutsideOfTheCamerasRange) {
  serve();
  AravisCameraLink link({.address = address});
  ASSERT_TRUE(link.open());

  const auto set = link.set_exposure({.exposure = 5000s, .gain_db = 0.0});

  ASSERT_FALSE(set.has_value());
  EXPECT_EQ(set.error().code, ErrorCode::DeviceRefused);
}

TEST_F(AravisCameraWire, HasNoFrameBeforeATrigger) {
  serve();
  AravisCameraLink link({.address = address});
  GenicamCamera camera(link, config(), clock);
  ASSERT_TRUE(camera.ensure_open());

  const auto popped = link.pop(10ms);

  ASSERT_TRUE(popped);
  EXPECT_FALSE(popped->has_value());
}

TEST_F(AravisCameraWire, SaysThatAnotherControllerHoldsTheCamera) {
  serve();
  AravisCameraLink holder({.address = address});
  ASSERT_TRUE(holder.open());
  AravisCameraLink link({.address = address, .control_wait = 0s});

  const auto opened = link.open();

  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().code, ErrorCode::ControlLost);
  EXPECT_THAT(opened.error().seen, HasSubstr("another controller"));
}

/// Takes control as a controller does that is killed right after: one WRITEREG of the control channel privilege, and
/// never a heartbeat (GigE Vision 2.0, 18.1).
void take_control_and_die(const std::string& address) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(3956);
  inet_pton(AF_INET, address.c_str(), &to.sin_addr);
  ASSERT_EQ(connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  const std::array<std::uint8_t, 16> write_register{0x42, 0x01, 0x00, 0x82, 0x00, 0x08, 0x00, 0x01,
                                                    0x00, 0x00, 0x0A, 0x00, 0x00, 0x00, 0x00, 0x02};
  ASSERT_EQ(send(fd, write_register.data(), write_register.size(), 0), 16);
  std::array<std::uint8_t, 64> acknowledge{};
  ASSERT_GE(recv(fd, acknowledge.data(), acknowledge.size(), 0), 8);
  EXPECT_EQ(acknowledge[0], 0x00);  // status: success
  close(fd);
}

TEST_F(AravisCameraWire, WaitsOutTheHoldOfAControllerThatWasKilled) {
  serve();
  take_control_and_die(address);
  AravisCameraLink link({.address = address, .control_wait = 60s});

  const auto opened = link.open();

  EXPECT_TRUE(opened.has_value()) << describe(opened.error());
}

TEST_F(AravisCameraWire, SeesThatTheCameraWasPoweredUpAnewAndWritesItsSettingsAgain) {
  serve();
  AravisCameraLink link({.address = address});
  GenicamCamera camera(link, config(), clock);
  ASSERT_TRUE(camera.apply({.exposure = 3ms, .gain_db = 6.0}));
  server.reset();
  serve();

  while (!link.has_lost_control())
    static_cast<void>(link.pop(20ms));  // Aravis' heartbeat notices, within about a second
  const auto frame = take(camera);

  ASSERT_TRUE(frame) << describe(frame.error());
  EXPECT_EQ(frame->settings, (ExposureSettings{3ms, 6.0}));
}

}  // namespace
}  // namespace gonio::drivers
