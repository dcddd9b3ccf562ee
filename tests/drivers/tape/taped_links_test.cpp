// A link that is recorded is a link like any other; and what was recorded answers in its place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/links/tape/exchange_bytes.h"
#include "drivers/links/tape/replay_links.h"
#include "drivers/links/tape/taped_camera_link.h"
#include "drivers/links/tape/taped_modbus_link.h"
#include "drivers/links/tape/taped_usbtmc_link.h"
#include "tests/drivers/scripted_modbus_link.h"
#include "tests/drivers/tape/memory_tape.h"

namespace gonio::drivers {
namespace {

using test::MemoryTape;
using test::ScriptedModbusLink;
using testing::NiceMock;
using testing::Return;

const Error kSilence{.code = ErrorCode::TimedOut, .device = "x", .tried = "ask", .seen = "nothing", .limit = "1 s"};

class MockCamera : public CameraLink {
 public:
  MOCK_METHOD(Result<DetectorIdentity>, open, (), (override));
  MOCK_METHOD(void, close, (), (override));
  MOCK_METHOD(bool, is_open, (), (const, override));
  MOCK_METHOD(bool, has_lost_control, (), (const, override));
  MOCK_METHOD(Result<void>, set_format, (const CameraFormat&), (override));
  MOCK_METHOD(Result<CameraFormat>, format, (), (override));
  MOCK_METHOD(Result<void>, set_exposure, (const ExposureSettings&), (override));
  MOCK_METHOD(Result<ExposureSettings>, exposure, (), (override));
  MOCK_METHOD(Result<std::optional<double>>, temperature_c, (), (override));
  MOCK_METHOD(Result<void>, start, (), (override));
  MOCK_METHOD(void, stop, (), (override));
  MOCK_METHOD(bool, is_streaming, (), (const, override));
  MOCK_METHOD(Result<void>, trigger, (), (override));
  MOCK_METHOD(Result<std::optional<CameraFrame>>, pop, (Duration), (override));
};

class MockUsb : public UsbtmcLink {
 public:
  MOCK_METHOD(Result<DetectorIdentity>, open, (), (override));
  MOCK_METHOD(void, close, (), (override));
  MOCK_METHOD(bool, is_open, (), (const, override));
  MOCK_METHOD(UsbtmcInterface, interface, (), (const, override));
  MOCK_METHOD(Result<void>, bulk_out, (std::span<const std::uint8_t>, Duration), (override));
  MOCK_METHOD(Result<std::vector<std::uint8_t>>, bulk_in, (std::size_t, Duration), (override));
  MOCK_METHOD(Result<std::vector<std::uint8_t>>, interrupt_in, (Duration), (override));
  MOCK_METHOD(Result<std::vector<std::uint8_t>>, control_in, (const usbtmc::ControlRequest&, Duration), (override));
  MOCK_METHOD(Result<void>, clear_halt, (std::uint8_t), (override));
};

class TapedLinks : public testing::Test {
 protected:
  // Plays what has been recorded.
  TapePlayer& play() {
    auto reader = MemoryTape::read(tape.file());
    EXPECT_TRUE(reader) << describe(reader.error());
    reader_.emplace(std::move(*reader));
    player_.emplace(*reader_);
    return *player_;
  }

  ManualClock clock;
  MemoryTape tape;

 private:
  std::optional<TapeReader> reader_;
  std::optional<TapePlayer> player_;
};

// Everything that a stage's link can do and meet, in one go: what it returned, in words.
std::vector<std::string> use(ModbusLink& link) {
  std::vector<std::string> seen;
  const auto note = [&seen](const Result<void>& done, std::span<const std::uint16_t> words) {
    std::string text = done ? "done" : describe(done.error());
    for (const std::uint16_t word : words) text += " " + std::to_string(word);
    seen.push_back(text);
  };
  std::array<std::uint16_t, 3> words{};
  const std::array<std::uint16_t, 2> written{700, 65535};
  note(link.write_registers(5, written), {});
  note(link.read_registers(4, words), words);
  note(link.write_and_read(6, written, 5, words), words);
  note(link.write_registers(9, written), {});
  link.resync();
  note(link.read_registers(9, words), words);
  return seen;
}

TEST_F(TapedLinks, PassAllOfModbusThroughAndReplayItAsItWas) {
  ScriptedModbusLink bare;
  bare.script = {ScriptedModbusLink::Next::Obey, ScriptedModbusLink::Next::Obey, ScriptedModbusLink::Next::Obey,
                 ScriptedModbusLink::Next::LoseReply};
  ScriptedModbusLink beneath;
  beneath.script = bare.script;
  TapedModbusLink taped(beneath, {tape, clock, TapeParty::Stage});

  const std::vector<std::string> expected = use(bare);
  EXPECT_EQ(use(taped), expected);
  ReplayModbusLink replayed(play(), TapeParty::Stage);

  EXPECT_EQ(use(replayed), expected);
}

TEST_F(TapedLinks, PassAllOfACameraThroughAndReplayItAsItWas) {
  NiceMock<MockCamera> camera;
  const CameraFormat format{
      .width = 2, .height = 3, .offset_x = 8, .offset_y = 4, .pixel_format = "Mono12", .packet_size_bytes = 1400};
  const ExposureSettings settings{.exposure = std::chrono::milliseconds(7), .gain_db = 1.5};
  CameraFrame frame{.is_complete = true, .trouble = {}, .width = 2, .height = 3, .pixels = {1, 2, 3, 4, 5, 4095}};
  frame.frame_id = 12;
  frame.camera_time_ns = 99;
  ON_CALL(camera, open).WillByDefault(Return(DetectorIdentity{"v", "m", "s"}));
  ON_CALL(camera, is_open).WillByDefault(Return(true));
  ON_CALL(camera, has_lost_control).WillByDefault(Return(true));
  ON_CALL(camera, format).WillByDefault(Return(format));
  ON_CALL(camera, exposure).WillByDefault(Return(settings));
  EXPECT_CALL(camera, set_format(format));
  EXPECT_CALL(camera, set_exposure(settings)).WillOnce(Return(failure(kSilence)));
  EXPECT_CALL(camera, stop());
  EXPECT_CALL(camera, temperature_c).WillOnce(Return(31.25)).WillOnce(Return(std::nullopt));
  EXPECT_CALL(camera, close());
  EXPECT_CALL(camera, pop).WillOnce(Return(std::nullopt)).WillOnce(Return(frame));
  TapedCameraLink taped(camera, {tape, clock, TapeParty::Detector});

  const auto use_it = [&](CameraLink& link) {
    EXPECT_EQ(link.open()->model, "m");
    EXPECT_TRUE(link.is_open());
    EXPECT_TRUE(link.has_lost_control());
    EXPECT_TRUE(link.set_format(format));
    EXPECT_EQ(*link.format(), format);
    EXPECT_EQ(link.set_exposure(settings).error(), kSilence);
    EXPECT_EQ(*link.exposure(), settings);
    EXPECT_EQ(*link.temperature_c(), std::optional<double>(31.25));
    EXPECT_EQ(*link.temperature_c(), std::nullopt);
    EXPECT_TRUE(link.start());
    EXPECT_FALSE(link.is_streaming());
    EXPECT_TRUE(link.trigger());
    EXPECT_FALSE(link.pop(Duration(5))->has_value());
    const auto popped = link.pop(Duration(6));
    ASSERT_TRUE(popped && *popped);
    EXPECT_EQ((*popped)->pixels, frame.pixels);
    EXPECT_EQ((*popped)->frame_id, 12U);
    EXPECT_EQ((*popped)->camera_time_ns, 99U);
    link.stop();
    link.close();
  };
  use_it(taped);
  TapePlayer& player = play();
  ReplayCameraLink replayed(player, TapeParty::Detector);
  use_it(replayed);

  EXPECT_FALSE(player.difference().has_value());
}

TEST_F(TapedLinks, PassAllOfAUsbDeviceThroughAndReplayItAsItWas) {
  using Bytes = std::vector<std::uint8_t>;
  NiceMock<MockUsb> usb;
  ON_CALL(usb, open).WillByDefault(Return(DetectorIdentity{"v", "m", "s"}));
  ON_CALL(usb, is_open).WillByDefault(Return(true));
  ON_CALL(usb, interface).WillByDefault(Return(UsbtmcInterface{1, 2, 0x82, 0x83}));
  ON_CALL(usb, bulk_in).WillByDefault(Return(Bytes{1, 2}));
  ON_CALL(usb, interrupt_in).WillByDefault(Return(failure(kSilence)));
  ON_CALL(usb, control_in).WillByDefault(Return(Bytes{3}));
  EXPECT_CALL(usb, close());
  TapedUsbtmcLink taped(usb, {tape, clock, TapeParty::Monitor});

  const auto use_it = [](UsbtmcLink& link) {
    const Bytes bytes{7, 8, 9};
    EXPECT_EQ(link.open()->serial, "s");
    EXPECT_TRUE(link.is_open());
    EXPECT_EQ(link.interface().bulk_in, 0x82);
    EXPECT_TRUE(link.bulk_out(bytes, Duration(1)));
    EXPECT_EQ(*link.bulk_in(64, Duration(1)), (Bytes{1, 2}));
    EXPECT_EQ(link.interrupt_in(Duration(1)).error(), kSilence);
    EXPECT_EQ(*link.control_in(usbtmc::get_capabilities(1), Duration(1)), Bytes{3});
    EXPECT_TRUE(link.clear_halt(2));
    link.close();
  };
  use_it(taped);
  TapePlayer& player = play();
  ReplayUsbtmcLink replayed(player, TapeParty::Monitor);
  use_it(replayed);

  EXPECT_FALSE(player.difference().has_value());
  EXPECT_EQ(player.exchanges(), 7);  // queries are none
}

TEST_F(TapedLinks, TimeEachExchangeByTheClock) {
  ScriptedModbusLink beneath;
  TapedModbusLink taped(beneath, {tape, clock, TapeParty::Stage});
  const std::array<std::uint16_t, 1> word{1};
  clock.advance(std::chrono::seconds(2));

  ASSERT_TRUE(taped.write_registers(1, word));

  const auto& exchange = std::get<TapeExchange>(tape.records.at(0));
  EXPECT_EQ(exchange.asked, clock.now());
  EXPECT_EQ(exchange.answered, clock.now());
}

TEST(ExchangeWords, SayRegistersAndValues) {
  const std::array<std::uint16_t, 2> words{0x12, 0xABCD};

  EXPECT_EQ(in_words(TapeCall::ReadRegisters, request_to_read(128, 17)), "read 17 registers from 128");
  EXPECT_EQ(in_words(TapeCall::WriteRegisters, request_to_write(5, words)), "write 2 registers from 5: 0x0012 0xABCD");
  EXPECT_EQ(in_words(TapeCall::WriteAndRead, request_to_write_and_read(5, words, 7, 40)),
            "write 2 registers from 5: 0x0012 0xABCD, read 40 registers from 7");
}

}  // namespace
}  // namespace gonio::drivers
