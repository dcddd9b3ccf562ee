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
#include "drivers/links/pixel_unpacking.h"
#include "sim/scene/read_scene.h"
#include "sim/wires/gige_camera_server.h"

namespace gonio::drivers {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

sim::Scene scene(const std::string& pixel_format = "Mono12", bool has_temperature = true) {
  auto read = sim::read_scene(GONIO_SCENE_DIR "/lambertian.toml");
  EXPECT_TRUE(read) << describe(read.error());
  sim::Scene scene = std::move(*read);
  scene.detector.pixel_format = pixel_format;
  scene.detector.bits = pixel_format_of_name(pixel_format)->significant_bits;
  scene.detector.has_temperature = has_temperature;
  return scene;
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

TEST_F(AravisCameraWire, ReadsARegionOfTheSensor) {
  serve();
  AravisCameraLink link({.address = address});
  GenicamCameraConfig region = config();
  region.format.width = 20;
  region.format.height = 12;
  region.format.offset_x = 22;
  region.format.offset_y = 26;
  GenicamCamera camera(link, region, clock);

  const auto frame = take(camera);
  const auto format = link.format();

  ASSERT_TRUE(frame) << describe(frame.error());
  EXPECT_EQ(frame->width, 20);
  EXPECT_EQ(frame->height, 12);
  EXPECT_EQ(frame->pixels.size(), 240U);
  ASSERT_TRUE(format);
  EXPECT_EQ(*format, region.format);
}

TEST_F(AravisCameraWire, RefusesARegionThatReachesBeyondTheSensor) {
  serve();
  AravisCameraLink link({.address = address});
  GenicamCameraConfig region = config();
  region.format.offset_x = 1;
  GenicamCamera camera(link, region, clock);

  const auto opened = camera.ensure_open();

  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::DeviceRefused);
  EXPECT_THAT(opened.error().tried, HasSubstr("from (1, 0)"));
}

// The camera's clock ticks every 8 ns, its zero is this machine's: a frame's time lies between trigger and arrival.
TEST_F(AravisCameraWire, TurnsTheCamerasTicksIntoNanoseconds) {
  serve();
  AravisCameraLink link({.address = address});
  GenicamCamera camera(link, config(), clock);
  ASSERT_TRUE(camera.ensure_open());
  const auto before = static_cast<std::uint64_t>(clock.now().time_since_epoch().count());

  const auto frame = take(camera);

  ASSERT_TRUE(frame) << describe(frame.error());
  EXPECT_GE(frame->camera_time_ns, before);
  EXPECT_LE(frame->camera_time_ns, static_cast<std::uint64_t>(frame->arrived.time_since_epoch().count()));
  EXPECT_EQ(frame->camera_time_ns % 8, 0U);
}

TEST_F(AravisCameraWire, ReadsTheTemperatureOfACameraThatHasOne) {
  serve();
  AravisCameraLink link({.address = address});
  GenicamCamera camera(link, config(), clock);

  const auto frame = take(camera);

  ASSERT_TRUE(frame) << describe(frame.error());
  EXPECT_EQ(frame->temperature_c, in_celsius(instrument.scene().environment.detector));
}

/// One simulated camera of another make.
class OtherCameraWire : public testing::Test {
 protected:
  static Result<Frame> frame_of(const std::string& pixel_format, bool has_temperature) {
    SystemClock clock;
    sim::LiveInstrument instrument{scene(pixel_format, has_temperature), {}, clock};
    const auto server = sim::GigeCameraServer::start(instrument, own_address());
    if (!server) return failure(server.error());
    AravisCameraLink link({.address = own_address()});
    GenicamCamera camera(
        link,
        {.serial = instrument.scene().detector.serial,
         .format = {.width = 64, .height = 64, .pixel_format = pixel_format, .packet_size_bytes = 1400},
         .settings = {.exposure = 2ms, .gain_db = 0.0}},
        clock);
    if (auto triggered = camera.trigger(); !triggered) return failure(triggered.error());
    for (;;) {
      auto collected = camera.collect(100ms);
      if (!collected) return failure(collected.error());
      if (*collected) return std::move(**collected);
    }
  }
};

TEST_F(OtherCameraWire, HasNoTemperatureWhereTheCameraHasNoSensor) {
  const auto frame = frame_of("Mono12", false);

  ASSERT_TRUE(frame) << describe(frame.error());
  EXPECT_EQ(frame->temperature_c, std::nullopt);
}

// The same dark frame (one seed, one exposure number) must come out of every format that holds its bits.
TEST_F(OtherCameraWire, ReadsTheSamePixelsFromEveryPackingOfTheirBits) {
  for (const std::vector<std::string>& alike :
       {std::vector<std::string>{"Mono10", "Mono10Packed", "Mono10p"}, {"Mono12", "Mono12Packed", "Mono12p"}}) {
    const auto plain = frame_of(alike[0], true);
    ASSERT_TRUE(plain) << describe(plain.error());
    for (const std::string& packed : {alike[1], alike[2]}) {
      const auto frame = frame_of(packed, true);

      ASSERT_TRUE(frame) << packed << ": " << describe(frame.error());
      EXPECT_EQ(frame->significant_bits, plain->significant_bits);
      EXPECT_EQ(frame->pixels, plain->pixels) << packed;
    }
  }
}

TEST_F(OtherCameraWire, ReadsEightFourteenAndSixteenBits) {
  for (const std::string name : {"Mono8", "Mono14", "Mono16"}) {
    const auto frame = frame_of(name, true);

    ASSERT_TRUE(frame) << name << ": " << describe(frame.error());
    const double mean = std::accumulate(frame->pixels.begin(), frame->pixels.end(), 0.0) / (64.0 * 64.0);
    EXPECT_NEAR(mean, scene().detector.offset_dn, 2.0) << name;
  }
}

/// Two cameras with serial numbers of this process' own: others may answer the same broadcast.
TEST(CameraSearch, FindsTheOneWithTheSerialNumberAndOpensNoOther) {
  const std::string serial = "S" + std::to_string(getpid());
  SystemClock clock;
  sim::Scene wanted = scene();
  wanted.detector.serial = serial;
  sim::Scene other = scene();
  other.detector.serial = serial + "B";
  sim::LiveInstrument first{wanted, {}, clock};
  sim::LiveInstrument second{other, {}, clock};
  const std::string at = own_address();
  const std::string beside = at.substr(0, 4) + std::to_string(128 + getpid() % 100) + at.substr(at.find('.', 4));
  const auto server = sim::GigeCameraServer::start(first, at);
  const auto server_beside = sim::GigeCameraServer::start(second, beside);
  ASSERT_TRUE(server && server_beside);
  AravisCameraLink link({.address = "", .serial = serial});
  AravisCameraLink holder({.address = beside, .control_wait = 0s});

  const auto opened = link.open();
  const auto held = holder.open();

  ASSERT_TRUE(opened) << describe(opened.error());
  EXPECT_EQ(opened->serial, serial);
  EXPECT_TRUE(held) << "the other camera is free: " << describe(held.error());
}

TEST(CameraSearch, SaysWhichCamerasItSawInstead) {
  const std::string serial = "T" + std::to_string(getpid());
  SystemClock clock;
  sim::Scene there = scene();
  there.detector.serial = serial;
  sim::LiveInstrument instrument{there, {}, clock};
  const auto server = sim::GigeCameraServer::start(instrument, own_address());
  ASSERT_TRUE(server);
  AravisCameraLink link({.address = "", .serial = "nobody"});

  const auto opened = link.open();

  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::Unreachable);
  EXPECT_THAT(opened.error().tried, HasSubstr("nobody"));
  EXPECT_THAT(opened.error().seen, HasSubstr(serial));
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
