#include "drivers/links/tape/tape_format.h"

#include <string>
#include <utility>

#include "drivers/links/tape/packing.h"
#include "drivers/links/tape/tape_bytes.h"

namespace gonio::drivers {
namespace {

// The first byte of a payload.
enum class Kind : std::uint8_t { Start = 1, Turn = 2, Exchange = 3, Input = 4, Reading = 5, End = 6 };

// The second bytes of an exchange: what follows.
constexpr std::uint8_t kHasError = 1;
constexpr std::uint8_t kHasPixels = 2;
constexpr std::uint8_t kAllParts = kHasError | kHasPixels;

// A frame packs to no less than this part of itself: deflate's own bound is 1 : 1032.
constexpr std::size_t kMostPacking = 1032;

std::int64_t ns_of(Instant t) {
  return t.time_since_epoch().count();
}
Instant instant_of(std::int64_t ns) {
  return Instant(Duration(ns));
}

ByteWriter begin(Kind kind) {
  ByteWriter out;
  out.u8(static_cast<std::uint8_t>(kind));
  return out;
}

std::vector<std::uint8_t> encode(const TapeStart& start) {
  return begin(Kind::Start)
      .text(start.program_version)
      .text(start.instrument_text)
      .text(start.configuration_hash)
      .text(start.boot_id)
      .i64(start.utc.time_since_epoch().count())
      .i64(ns_of(start.boottime))
      .i64(start.last_event)
      .take();
}

std::vector<std::uint8_t> encode(const TapeTurn& turn) {
  return begin(Kind::Turn)
      .u8(static_cast<std::uint8_t>(turn.party))
      .u8(turn.source)
      .i64(ns_of(turn.now))
      .i64(turn.argument)
      .take();
}

std::vector<std::uint8_t> encode(const TapeExchange& exchange) {
  ByteWriter out = begin(Kind::Exchange);
  out.u8(static_cast<std::uint8_t>((exchange.error ? kHasError : 0) | (exchange.pixels.empty() ? 0 : kHasPixels)));
  out.u8(static_cast<std::uint8_t>(exchange.party)).u8(exchange.link).u8(static_cast<std::uint8_t>(exchange.call));
  out.i64(ns_of(exchange.asked)).i64(ns_of(exchange.answered)).blob(exchange.request);
  if (exchange.error) {
    const Error& error = *exchange.error;
    out.text(traits(error.code).name).text(error.device).text(error.tried).text(error.seen).text(error.limit);
  }
  out.blob(exchange.reply);
  if (!exchange.pixels.empty()) {
    out.u32(static_cast<std::uint32_t>(exchange.pixels.size())).blob(pack_pixels(exchange.pixels));
  }
  return out.take();
}

std::vector<std::uint8_t> encode(const TapeInput& input) {
  return begin(Kind::Input).text(input.kind).text(input.text).take();
}

std::vector<std::uint8_t> encode(const TapeReading& reading) {
  return begin(Kind::Reading)
      .u8(static_cast<std::uint8_t>(reading.party))
      .u8(reading.is_utc ? 1 : 0)
      .i64(reading.ns)
      .take();
}

std::vector<std::uint8_t> encode(const TapeEnd& end) {
  return begin(Kind::End).text(end.reason).take();
}

tl::unexpected<Error> damaged(std::string seen) {
  return failure({.code = ErrorCode::IncompleteData,
                  .device = "tape",
                  .tried = "read a record",
                  .seen = std::move(seen),
                  .limit = {}});
}

TapeStart decode_start(ByteReader& in) {
  TapeStart start;
  start.program_version = in.text();
  start.instrument_text = in.text();
  start.configuration_hash = in.text();
  start.boot_id = in.text();
  start.utc = UtcTime(Duration(in.i64()));
  start.boottime = instant_of(in.i64());
  start.last_event = in.i64();
  return start;
}

Result<TapeParty> decode_party(ByteReader& in) {
  const std::uint8_t party = in.u8();
  if (party < 1 || party > kTapePartyCount) return damaged("party " + std::to_string(party));
  return static_cast<TapeParty>(party);
}

Result<TapeTurn> decode_turn(ByteReader& in) {
  const Result<TapeParty> party = decode_party(in);
  if (!party) return failure(party.error());
  TapeTurn turn{.party = *party};
  turn.source = in.u8();
  turn.now = instant_of(in.i64());
  turn.argument = in.i64();
  return turn;
}

Result<Error> decode_error(ByteReader& in) {
  const std::string name = in.text();
  const std::optional<ErrorCode> code = error_code_from_name(name);
  if (!code) return damaged("an error \"" + name.substr(0, 40) + "\", which this version does not know");
  Error error{.code = *code, .device = in.text(), .tried = {}, .seen = {}, .limit = {}};
  error.tried = in.text();
  error.seen = in.text();
  error.limit = in.text();
  return error;
}

Result<std::vector<std::uint16_t>> decode_pixels(ByteReader& in) {
  const std::size_t count = in.u32();
  const std::span<const std::uint8_t> packed = in.blob();
  if (count == 0 || count > kMostPixels || 2 * count > kMostPacking * packed.size()) {
    return damaged("a frame of " + std::to_string(count) + " pixels in " + std::to_string(packed.size()) + " bytes");
  }
  return unpack_pixels(packed, count);
}

Result<TapeExchange> decode_exchange(ByteReader& in) {
  const std::uint8_t parts = in.u8();
  if ((parts & ~kAllParts) != 0) return damaged("parts " + std::to_string(parts) + " of an exchange");
  const Result<TapeParty> party = decode_party(in);
  if (!party) return failure(party.error());
  TapeExchange exchange{.party = *party};
  exchange.link = in.u8();
  exchange.call = static_cast<TapeCall>(in.u8());
  if (tape_call_name(exchange.call).empty()) {
    return damaged("call " + std::to_string(static_cast<int>(exchange.call)));
  }
  exchange.asked = instant_of(in.i64());
  exchange.answered = instant_of(in.i64());
  const std::span<const std::uint8_t> request = in.blob();
  exchange.request.assign(request.begin(), request.end());
  if ((parts & kHasError) != 0) {
    Result<Error> error = decode_error(in);
    if (!error) return failure(std::move(error).error());
    exchange.error = std::move(*error);
  }
  const std::span<const std::uint8_t> reply = in.blob();
  exchange.reply.assign(reply.begin(), reply.end());
  if ((parts & kHasPixels) != 0) {
    Result<std::vector<std::uint16_t>> pixels = decode_pixels(in);
    if (!pixels) return failure(std::move(pixels).error());
    exchange.pixels = std::move(*pixels);
  }
  return exchange;
}

Result<TapeReading> decode_reading(ByteReader& in) {
  const Result<TapeParty> party = decode_party(in);
  if (!party) return failure(party.error());
  const std::uint8_t kind = in.u8();
  if (kind > 1) return damaged("clock " + std::to_string(kind));
  return TapeReading{.party = *party, .is_utc = kind == 1, .ns = in.i64()};
}

TapeInput decode_input(ByteReader& in) {
  TapeInput input;
  input.kind = in.text();
  input.text = in.text();
  return input;
}

template <class T>
Result<TapeRecord> as_record(Result<T> record) {
  if (!record) return failure(std::move(record).error());
  return TapeRecord(std::move(*record));
}

Result<TapeRecord> decode_kind(std::uint8_t kind, ByteReader& in) {
  switch (static_cast<Kind>(kind)) {
    case Kind::Start:
      return decode_start(in);
    case Kind::Turn:
      return as_record(decode_turn(in));
    case Kind::Exchange:
      return as_record(decode_exchange(in));
    case Kind::Input:
      return decode_input(in);
    case Kind::Reading:
      return as_record(decode_reading(in));
    case Kind::End:
      return TapeEnd{in.text()};
  }
  return damaged("a record of kind " + std::to_string(kind));
}

}  // namespace

std::vector<std::uint8_t> encode_record(const TapeRecord& record) {
  return std::visit([](const auto& one) { return encode(one); }, record);
}

Result<TapeRecord> decode_record(std::span<const std::uint8_t> payload) {
  if (payload.empty()) return damaged("nothing in it");
  ByteReader in(payload.subspan(1));
  Result<TapeRecord> record = decode_kind(payload[0], in);
  if (record && !in.is_done()) return damaged(in.is_whole() ? "more in it than belongs there" : "it is too short");
  return record;
}

}  // namespace gonio::drivers
