// What comes back on a serial line, through libmodbus and a pseudo terminal: the bytes of one frame are there already.
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

#include "drivers/links/modbus_context.h"
#include "drivers/links/modbus_frames.h"
#include "sim/wires/serial_pty.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"
#include "tests/support/temporary_folder.h"

namespace gonio::fuzz {
namespace {

constexpr std::uint8_t kUnit = 17;
constexpr std::size_t kMostBytes = 300;  // more than a frame has

// A line with both of its ends here.
class Line {
 public:
  Line()
      : pty_(sim::SerialPty::open(folder_ / "tty").value()),
        context_(drivers::ModbusContext::rtu(
            {.device = folder_ / "tty", .parity = drivers::Parity::None, .stop_bits = 2}, kUnit)),
        tty_(context_.open_line().value()) {}

  // Bytes pass through a queue of the kernel's: they are here when the near end counts all of them.
  void say(Bytes bytes) {
    hold(::write(pty_.descriptor(), bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()),
         "a line takes a few bytes");
    for (int arrived = 0; arrived < static_cast<int>(bytes.size());) ::ioctl(tty_, FIONREAD, &arrived);
  }
  Result<std::vector<std::uint8_t>> receive() { return context_.receive(); }
  void flush() const { ::tcflush(tty_, TCIFLUSH); }

 private:
  test::TemporaryFolder folder_;
  sim::SerialPty pty_;
  drivers::ModbusContext context_;
  int tty_;
};

// Modbus over Serial Line V1.02, 6.2.2, bit by bit.
std::uint16_t crc_of(Bytes bytes) {
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? crc >> 1U ^ 0xA001U : crc >> 1U;
  }
  return static_cast<std::uint16_t>(crc);
}

// A reply to a read, whose frame is valid in itself: unit, function, byte count, words, CRC.
bool is_read_reply(Bytes frame) {
  const std::size_t size = frame.size();
  if (size < 5 || frame[0] != kUnit || frame[1] != 0x03 || size != 5U + frame[2]) return false;
  return crc_of(frame.first(size - 2)) == (frame[size - 2] | frame[size - 1] << 8U);
}

}  // namespace

void modbus_rtu(Bytes input) {
  static Line line;
  ByteSource source(input);
  const std::size_t count = 1 + source.byte() % 125;
  // A CRC is seldom guessed: the input says whether it comes with the right one.
  const bool adds_crc = (source.byte() & 1U) != 0;
  const Bytes given = source.some(kMostBytes);
  std::vector<std::uint8_t> said(given.begin(), given.end());
  if (adds_crc) {
    const std::uint16_t crc = crc_of(said);
    said.push_back(static_cast<std::uint8_t>(crc));
    said.push_back(static_cast<std::uint8_t>(crc >> 8U));
  }
  if (said.empty()) return;
  line.say(said);

  const auto frame = line.receive();

  line.flush();
  if (!frame) {
    hold_error(frame.error());
    return;
  }
  hold(frame->size() + 2 <= said.size() && std::equal(frame->begin(), frame->end(), said.begin()),
       "a frame is what was said");
  hold(frame->front() == kUnit || frame->front() == 0, "a frame is of our unit, or of all (which the line refuses)");
  const std::uint16_t crc = crc_of(*frame);
  hold(said[frame->size()] == (crc & 0xFFU) && said[frame->size() + 1] == crc >> 8U, "a frame bears its CRC");
  std::vector<std::uint16_t> words(count);
  const auto taken = drivers::take_reply(drivers::read_request(0, count), Bytes(*frame).subspan(1), words);
  const Bytes whole = Bytes(said).first(frame->size() + 2);
  hold((taken.has_value() && frame->front() == kUnit) == (is_read_reply(whole) && whole[2] == 2 * count),
       "a read takes what was asked for, no more and no less");
}

}  // namespace gonio::fuzz
