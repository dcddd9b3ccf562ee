// The adapter of libmodbus: nothing else in this room knows it.
#include "sim/wires/modbus_reply.h"

#include <modbus/modbus.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <variant>

#include "sim/wires/file_descriptor.h"

namespace gonio::sim {
namespace {

constexpr std::uint8_t kExceptionBit = 0x80;
constexpr std::size_t kPdu = 7;  // where the function code stands in a TCP frame
constexpr unsigned kMostRead = 125;
constexpr unsigned kMostWritten = 123;
constexpr unsigned kMostWrittenAndRead = 121;
constexpr int kAddresses = 0x10000;
constexpr unsigned kNoSuchUnit = 0x0B;  // gateway: the target does not respond

struct Run {
  std::uint16_t first = 0;
  std::uint16_t count = 0;
};

/// A request taken apart; a part that its function does not have is empty.
struct Request {
  std::optional<Run> read;
  std::optional<Run> write;
  std::vector<std::uint16_t> values;
};

std::uint16_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8U | bytes[at + 1]);
}

Run run_at(std::span<const std::uint8_t> pdu, std::size_t at) {
  return {word(pdu, at), word(pdu, at + 2)};
}

// `pdu` from its byte count on: the count, then the values.
bool take_values(std::span<const std::uint8_t> pdu, std::size_t at, Request& request) {
  const std::size_t bytes = std::size_t{2} * request.write->count;
  if (pdu.size() != at + 1 + bytes || pdu[at] != bytes) return false;
  for (std::size_t k = 0; k < request.write->count; ++k) request.values.push_back(word(pdu, at + 1 + 2 * k));
  return true;
}

bool is_run(const Run& run, unsigned most) {
  return run.count >= 1 && run.count <= most;
}

std::variant<Request, ModbusException> parse(std::span<const std::uint8_t> pdu) {
  Request request;
  switch (pdu[0]) {
    case MODBUS_FC_READ_HOLDING_REGISTERS:
    case MODBUS_FC_READ_INPUT_REGISTERS:
      if (pdu.size() != 5) return ModbusException::IllegalValue;
      request.read = run_at(pdu, 1);
      if (!is_run(*request.read, kMostRead)) return ModbusException::IllegalValue;
      return request;
    case MODBUS_FC_WRITE_SINGLE_REGISTER:
      if (pdu.size() != 5) return ModbusException::IllegalValue;
      request.write = Run{word(pdu, 1), 1};
      request.values.push_back(word(pdu, 3));
      return request;
    case MODBUS_FC_WRITE_MULTIPLE_REGISTERS:
      if (pdu.size() < 6) return ModbusException::IllegalValue;
      request.write = run_at(pdu, 1);
      if (!is_run(*request.write, kMostWritten) || !take_values(pdu, 5, request)) return ModbusException::IllegalValue;
      return request;
    case MODBUS_FC_WRITE_AND_READ_REGISTERS:
      if (pdu.size() < 10) return ModbusException::IllegalValue;
      request.read = run_at(pdu, 1);
      request.write = run_at(pdu, 5);
      if (!is_run(*request.read, kMostRead) || !is_run(*request.write, kMostWrittenAndRead) ||
          !take_values(pdu, 9, request)) {
        return ModbusException::IllegalValue;
      }
      return request;
    default:
      return ModbusException::IllegalFunction;
  }
}

}  // namespace

struct ModbusReply::Impl {
  modbus_t* context = nullptr;
  modbus_mapping_t* mapping = nullptr;
  FileDescriptor ours;
  FileDescriptor theirs;

  ~Impl() {
    modbus_mapping_free(mapping);
    modbus_free(context);
  }

  // Does the request; what the reply will read lies in the mapping afterwards.
  std::optional<ModbusException> serve(const Request& request, RegisterFace& face, Instant now) const {
    // What is to be read is looked at first: a request that is refused must not have acted.
    std::array<std::uint16_t, kMostRead> words{};
    const auto read_into = [&](const Run& run) {
      const auto out = std::span(words).first(run.count);
      const auto refused = face.read(run.first, out, now);
      if (!refused) std::memcpy(mapping->tab_registers + run.first, out.data(), out.size_bytes());
      if (!refused) std::memcpy(mapping->tab_input_registers + run.first, out.data(), out.size_bytes());
      return refused;
    };
    if (request.read) {
      if (const auto refused = read_into(*request.read)) return refused;
    }
    if (!request.write) return std::nullopt;
    if (const auto refused = face.write(request.write->first, request.values, now)) return refused;
    return request.read ? read_into(*request.read) : std::nullopt;
  }

  // The exception that it ends in; 0: none.
  unsigned obey(std::span<const std::uint8_t> pdu, RegisterFace& face, Instant now) const {
    const auto parsed = parse(pdu);
    const auto* wrong = std::get_if<ModbusException>(&parsed);
    const bool reads_inputs = pdu[0] == MODBUS_FC_READ_INPUT_REGISTERS;
    const bool reads_holding = pdu[0] == MODBUS_FC_READ_HOLDING_REGISTERS;
    if ((reads_inputs && !face.has_input_registers()) || (reads_holding && face.has_input_registers())) {
      return static_cast<unsigned>(ModbusException::IllegalFunction);
    }
    const auto refused = wrong != nullptr ? std::optional(*wrong) : serve(std::get<Request>(parsed), face, now);
    return refused ? static_cast<unsigned>(*refused) : 0;
  }
};

Result<ModbusReply> ModbusReply::make() {
  std::array<int, 2> pair{-1, -1};
  if (::socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0, pair.data()) != 0) {
    return failure({.code = ErrorCode::Internal,
                    .device = "goniosim",
                    .tried = "make a socket pair",
                    .seen = std::strerror(errno)});
  }
  auto impl = std::make_unique<Impl>();
  impl->theirs = FileDescriptor(pair[0]);
  impl->ours = FileDescriptor(pair[1]);
  impl->context = modbus_new_tcp("127.0.0.1", 502);  // never connected: it only builds frames into the socket pair
  impl->mapping = modbus_mapping_new(0, 0, kAddresses, kAddresses);
  if (impl->context == nullptr || impl->mapping == nullptr) {
    return failure({.code = ErrorCode::Internal,
                    .device = "goniosim",
                    .tried = "set up libmodbus",
                    .seen = modbus_strerror(errno)});
  }
  modbus_set_socket(impl->context, impl->theirs.get());
  modbus_set_response_timeout(impl->context, 0, 1000);  // or an exception reply sleeps for half a second
  return ModbusReply(std::move(impl));
}

ModbusReply::ModbusReply(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ModbusReply::ModbusReply(ModbusReply&&) noexcept = default;
ModbusReply& ModbusReply::operator=(ModbusReply&&) noexcept = default;
ModbusReply::~ModbusReply() = default;

std::vector<std::uint8_t> ModbusReply::answer(std::span<const std::uint8_t> request, ModbusUnits& units, Instant now) {
  RegisterFace* const face = units.unit(request[6]);
  const unsigned exception = face == nullptr ? kNoSuchUnit : impl_->obey(request.subspan(kPdu), *face, now);
  if (exception != 0) {
    modbus_reply_exception(impl_->context, request.data(), exception);
  } else {
    modbus_reply(impl_->context, request.data(), static_cast<int>(request.size()), impl_->mapping);
  }
  std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> frame{};
  const ssize_t n = ::recv(impl_->ours.get(), frame.data(), frame.size(), MSG_DONTWAIT);
  // libmodbus adds the bit, which a function that has it already would lose: 0x83 would be answered as a good 0x03.
  if (exception != 0) frame[kPdu] |= kExceptionBit;
  return n <= 0 ? std::vector<std::uint8_t>() : std::vector<std::uint8_t>(frame.begin(), frame.begin() + n);
}

std::vector<std::uint8_t> ModbusReply::answer_pdu(std::uint8_t unit, std::span<const std::uint8_t> pdu,
                                                  ModbusUnits& units, Instant now) {
  const std::size_t length = pdu.size() + 1;  // with the unit
  std::vector<std::uint8_t> request{
      0, 0, 0, 0, static_cast<std::uint8_t>(length >> 8U), static_cast<std::uint8_t>(length), unit};
  request.insert(request.end(), pdu.begin(), pdu.end());
  std::vector<std::uint8_t> reply = answer(request, units, now);
  reply.erase(reply.begin(), reply.begin() + static_cast<std::ptrdiff_t>(std::min(kPdu, reply.size())));
  return reply;
}

}  // namespace gonio::sim
