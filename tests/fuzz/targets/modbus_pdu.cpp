// A reply's PDU beside its request (Modbus Application Protocol V1.1b3, 6.3, 6.6, 6.12, 6.17).
#include <algorithm>
#include <vector>

#include "drivers/links/modbus_frames.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

enum class Kind { Read, WriteOne, WriteSeveral, WriteAndRead };

struct Question {
  Kind kind;
  std::uint16_t first;
  std::size_t count;
};

constexpr std::size_t kMostWords = 121;

drivers::ModbusRequest request_of(const Question& question, std::span<const std::uint16_t> words) {
  switch (question.kind) {
    case Kind::Read:
      return drivers::read_request(question.first, question.count);
    case Kind::WriteOne:
      return drivers::write_request(question.first, words.first(1));
    case Kind::WriteSeveral:
      return drivers::write_request(question.first, words);
    case Kind::WriteAndRead:
      break;
  }
  return drivers::write_and_read_request(question.first, words, question.first, question.count);
}

// What the standard says a good reply begins with; the words that were read follow.
std::vector<std::uint8_t> good_begin(const Question& question, std::uint16_t word) {
  const auto high = [](std::size_t w) { return static_cast<std::uint8_t>(w >> 8U); };
  const auto low = [](std::size_t w) { return static_cast<std::uint8_t>(w); };
  switch (question.kind) {
    case Kind::Read:
      return {0x03, low(2 * question.count)};
    case Kind::WriteOne:
      return {0x06, high(question.first), low(question.first), high(word), low(word)};
    case Kind::WriteSeveral:
      return {0x10, high(question.first), low(question.first), high(question.count), low(question.count)};
    case Kind::WriteAndRead:
      break;
  }
  return {0x17, low(2 * question.count)};
}

}  // namespace

void modbus_pdu(Bytes input) {
  ByteSource source(input);
  const auto kind = static_cast<Kind>(source.byte() % 4);
  const std::size_t least = kind == Kind::WriteSeveral ? 2 : 1;  // one word goes by FC6
  const Question question{kind, source.word(), std::max(least, source.byte() % (kMostWords + 1))};
  std::vector<std::uint16_t> written(question.count);
  for (std::size_t k = 0; k < written.size(); ++k) written[k] = static_cast<std::uint16_t>(0x1234 + 0x101 * k);
  const drivers::ModbusRequest request = request_of(question, written);
  const Bytes reply = source.rest();
  const bool reads = kind == Kind::Read || kind == Kind::WriteAndRead;
  std::vector<std::uint16_t> into(reads ? question.count : 0, 0xA5A5);

  const Result<void> taken = drivers::take_reply(request, reply, into);

  const auto begin = good_begin(question, written.front());
  const bool is_good =
      reply.size() == begin.size() + 2 * into.size() && std::ranges::equal(reply.first(begin.size()), begin);
  hold(taken.has_value() == is_good, "a reply is taken when it is the one to this request, and only then");
  if (!taken) {
    hold_error(taken.error());
    const bool is_refusal = reply.size() == 2 && reply[0] == (begin[0] | 0x80);
    hold((taken.error().code == ErrorCode::DeviceRefused) == is_refusal,
         "an exception is the unit's, anything else a bad reply");
    hold(std::ranges::all_of(into, [](std::uint16_t w) { return w == 0xA5A5; }), "nothing comes out of a bad reply");
    return;
  }
  for (std::size_t k = 0; k < into.size(); ++k) {
    const std::size_t at = begin.size() + 2 * k;
    hold(into[k] == reply[at] * 256 + reply[at + 1], "words are big-endian");
  }
}

}  // namespace gonio::fuzz
