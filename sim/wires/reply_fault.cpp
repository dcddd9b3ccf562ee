#include "sim/wires/reply_fault.h"

#include <algorithm>
#include <array>
#include <utility>

#include "sim/wires/rtu_frame.h"

namespace gonio::sim {
namespace {

using stage::Field;

constexpr std::size_t kUnit = 6;  // in a TCP frame

/// Where a request begins to write, and how many registers.
struct Written {
  std::size_t first = 0;
  std::size_t count = 0;
};

std::size_t number_at(std::span<const std::uint8_t> pdu, std::size_t at) {
  return static_cast<std::size_t>(pdu[at] << 8U | pdu[at + 1]);
}

constexpr std::uint8_t kReadAndWrite = 23;

std::optional<Written> written_by(std::span<const std::uint8_t> pdu) {
  constexpr std::uint8_t kWriteOne = 6;
  constexpr std::uint8_t kWriteMany = 16;
  constexpr std::size_t kBeforeItsWrite = 9;  // function, first and count to read, first and count to write
  if (pdu.size() < 5) return std::nullopt;
  if (pdu[0] == kWriteOne) return Written{number_at(pdu, 1), 1};
  if (pdu[0] == kWriteMany) return Written{number_at(pdu, 1), number_at(pdu, 3)};
  if (pdu[0] == kReadAndWrite && pdu.size() >= kBeforeItsWrite) return Written{number_at(pdu, 5), number_at(pdu, 7)};
  return std::nullopt;
}

// What does not depend on the frame.
FaultyReply spoil(const PlannedFault& fault, std::vector<std::uint8_t> reply) {
  switch (fault.kind) {
    case FaultKind::ReplyLost:
      return {};
    case FaultKind::ReplyLate:
      return {.bytes = std::move(reply), .late = fault.late()};
    case FaultKind::ReplyTorn:
      reply.resize(reply.size() / 2);
      return {.bytes = std::move(reply)};
    case FaultKind::ReplyDuplicated: {
      const std::size_t size = reply.size();
      reply.resize(2 * size);
      std::copy_n(reply.begin(), size, reply.begin() + static_cast<std::ptrdiff_t>(size));
      return {.bytes = std::move(reply)};
    }
    case FaultKind::StageReset:
      return {.bytes = {}, .late = {}, .resets = true};
    default:
      return {.bytes = std::move(reply)};
  }
}

}  // namespace

ExchangeKind exchange_kind(std::span<const std::uint8_t> pdu, const stage::RegisterMap& map) {
  const auto written = written_by(pdu);
  if (!written) return ExchangeKind::Look;
  const auto covers = [&](Field field) {
    const std::size_t at = map.at(field).address;
    return at >= written->first && at < written->first + written->count;
  };
  if (covers(Field::MotionCommand)) return ExchangeKind::Motion;
  if (covers(Field::SourceShutterCommand)) return ExchangeKind::Shutters;
  if (covers(Field::Heartbeat)) return ExchangeKind::Heartbeat;
  return pdu[0] == kReadAndWrite ? ExchangeKind::Look : ExchangeKind::Any;  // a look writes a token of its own
}

ExchangeFate fate_of_exchange(LiveInstrument::Parts& parts, std::span<const std::uint8_t> pdu) {
  const ExchangeKind kind = exchange_kind(pdu, parts.stage.map());
  ExchangeFate fate;
  fate.fault = parts.instrument.strike(FaultMoment::Exchange, parts.now, [kind](const PlannedFault& fault) {
    return fault.exchange() == kind || fault.exchange() == ExchangeKind::Any;
  });
  const FaultDesk& desk = parts.instrument.faults();
  fate.is_silent = desk.active(FaultKind::StageSilent, parts.now) != nullptr;
  fate.is_refused = desk.active(FaultKind::StageRefuse, parts.now) != nullptr;
  return fate;
}

FaultyReply spoil_tcp(const PlannedFault& fault, std::vector<std::uint8_t> reply,
                      std::span<const std::uint8_t> before) {
  if (fault.kind == FaultKind::ReplyWrongTransaction) ++reply[1];
  if (fault.kind == FaultKind::ReplyWrongUnit) ++reply[kUnit];
  if (fault.kind == FaultKind::ReplyStale && before.size() > kUnit) {
    // As a gateway answers from its memory: under the transaction id of now.
    const std::array<std::uint8_t, 2> transaction{reply[0], reply[1]};
    reply.assign(before.begin(), before.end());
    std::ranges::copy(transaction, reply.begin());
  }
  return spoil(fault, std::move(reply));
}

FaultyReply spoil_rtu(const PlannedFault& fault, std::vector<std::uint8_t> reply,
                      std::span<const std::uint8_t> before) {
  if (fault.kind == FaultKind::ReplyBadCrc) reply.back() = static_cast<std::uint8_t>(~reply.back());
  if (fault.kind == FaultKind::ReplyWrongUnit) {
    const std::vector<std::uint8_t> pdu(reply.begin() + 1, reply.end() - 2);
    reply = rtu_frame(static_cast<std::uint8_t>(reply.front() + 1), pdu);
  }
  if (fault.kind == FaultKind::ReplyStale && !before.empty()) reply.assign(before.begin(), before.end());
  return spoil(fault, std::move(reply));
}

std::vector<std::uint8_t> exception_pdu(std::span<const std::uint8_t> request, std::uint8_t code) {
  constexpr unsigned kException = 0x80;
  return {static_cast<std::uint8_t>(request.front() | kException), code};
}

}  // namespace gonio::sim
