// What comes back on a Modbus TCP connection, through libmodbus: the device's bytes are there before the request is
// sent.
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <vector>

#include "drivers/links/modbus_context.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

constexpr std::size_t kExchanges = 3;
constexpr std::size_t kMostWords = 121;
constexpr std::size_t kMostBytes = 2048;  // which a socket pair takes without a reader

class SocketPair {
 public:
  SocketPair() { hold(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends_.data()) == 0, "there is a socket pair"); }
  SocketPair(const SocketPair&) = delete;
  SocketPair& operator=(const SocketPair&) = delete;
  ~SocketPair() {
    for (const int end : ends_) ::close(end);
  }
  [[nodiscard]] int near() const { return ends_[0]; }
  // All that the device will ever say, then the end of the connection.
  void say(Bytes bytes) const {
    hold(::send(ends_[1], bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size()),
         "a socket pair takes a few bytes");
    ::shutdown(ends_[1], SHUT_WR);
  }

 private:
  std::array<int, 2> ends_{};
};

// The reply at the front of the stream as the Modbus Messaging on TCP/IP Implementation Guide V1.0b, 3.1.3, has it.
struct Frame {
  explicit Frame(Bytes stream) : bytes(stream) {}
  Bytes bytes;
  [[nodiscard]] std::size_t word(std::size_t at) const { return bytes[at] * 256U + bytes[at + 1]; }
  [[nodiscard]] bool is_read_reply(std::uint16_t transaction, std::uint8_t function, std::size_t words) const {
    return bytes.size() >= 9 + 2 * words && word(0) == transaction && bytes[7] == function && bytes[8] == 2 * words;
  }
};

Result<void> exchange(drivers::ModbusContext& context, std::uint8_t kind, std::span<std::uint16_t> into) {
  const std::vector<std::uint16_t> words(into.size(), 0x1234);
  if (kind == 0) return context.read_registers(7, into);
  if (kind == 1) return context.write_registers(7, words);
  return context.write_and_read(7, words, 9, into);
}

}  // namespace

void modbus_tcp(Bytes input) {
  ByteSource source(input);
  const auto kind = static_cast<std::uint8_t>(source.byte() % 3);
  const std::size_t count = 1 + source.byte() % kMostWords;
  Bytes stream = source.some(kMostBytes);
  auto context = drivers::ModbusContext::tcp(1, std::chrono::milliseconds(1));
  const SocketPair wire;
  wire.say(stream);
  context.use_socket(wire.near());
  for (std::uint16_t transaction = 1; transaction <= kExchanges; ++transaction) {
    std::vector<std::uint16_t> into(count, 0xA5A5);

    const Result<void> done = exchange(context, kind, into);

    if (!done) {
      hold_error(done.error());
      return;  // the link connects anew
    }
    if (kind == 1) {
      hold(stream.size() >= 12 && stream[1] == transaction && stream[7] == (count == 1 ? 0x06 : 0x10),
           "a write is done when its echo came");
      stream = stream.subspan(12);
      continue;
    }
    const Frame frame(stream);
    hold(frame.is_read_reply(transaction, kind == 0 ? 0x03 : 0x17, count),
         "a reply bears the request's transaction, function and size");
    for (std::size_t k = 0; k < count; ++k) hold(into[k] == frame.word(9 + 2 * k), "words are big-endian");
    stream = stream.subspan(9 + 2 * count);
  }
}

}  // namespace gonio::fuzz
