// The simulated stage's side of both Modbus wires: any request, from anybody.
#include <array>

#include "protocol/stage/register_map.h"
#include "sim/devices/instrument.h"
#include "sim/devices/stage_face.h"
#include "sim/wires/modbus_reply.h"
#include "sim/wires/rtu_frame.h"
#include "tests/fuzz/bench_scene.h"
#include "tests/fuzz/promise.h"
#include "tests/fuzz/targets.h"

namespace gonio::fuzz {
namespace {

constexpr std::size_t kMostPdu = 253;

void hold_reply(Bytes pdu, std::span<const std::uint8_t> reply) {
  hold(reply.size() >= 2 && reply.size() <= kMostPdu, "a reply is a PDU");
  if (reply[0] == (pdu[0] | 0x80)) {
    hold(reply.size() == 2 && reply[1] >= 1 && reply[1] <= 3, "a refusal is an exception of the standard");
    return;
  }
  hold(reply[0] == pdu[0], "a reply is of the request's function");
  if (pdu[0] == 0x03 || pdu[0] == 0x17)
    hold(reply.size() == 2U + reply[1] && reply[1] == 2 * pdu[4], "as many words as were asked for");
  if (pdu[0] == 0x06 || pdu[0] == 0x10)
    hold(reply.size() == 5 && std::equal(reply.begin(), reply.end(), pdu.begin()), "a write is echoed");
}

// A frame ends where its length says, or cannot be told to.
void check_framing(Bytes pdu) {
  const auto whole = sim::rtu_frame(1, pdu);
  hold(sim::has_good_crc(whole), "a frame bears its CRC");
  if (const auto length = sim::rtu_request_length(whole))
    hold(*length >= 4 && *length <= 3U + 9U + 255U + 2U, "a request's length is that of a frame");
}

}  // namespace

void modbus_request(Bytes input) {
  static const sim::Scene scene = bench_scene();
  static sim::ModbusReply reply = sim::ModbusReply::make().value();
  ByteSource source(input);
  Instant now{std::chrono::seconds(1000)};
  sim::Instrument instrument(scene, {}, now);
  sim::StageFace face(instrument);
  for (int request = 0; request < 40 && !source.is_empty(); ++request) {
    now += std::chrono::milliseconds(source.word());
    instrument.advance_to(now);
    const Bytes pdu = source.counted();
    if (pdu.empty() || pdu.size() > kMostPdu) continue;
    check_framing(pdu);
    hold_reply(pdu, reply.answer_pdu(1, pdu, face, now));
  }
  std::array<std::uint16_t, 1> identity{};
  hold(!face.read(scene.stage.registers.at(stage::Field::Identity).address, identity, now) &&
           identity[0] == stage::kIdentity,
       "the stage is still the stage");
}

}  // namespace gonio::fuzz
