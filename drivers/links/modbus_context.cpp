// The adapter of libmodbus: nothing else in this room knows it.
#include "drivers/links/modbus_context.h"

#include <fmt/format.h>
#include <modbus/modbus.h>
#include <sys/select.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <string>
#include <utility>

namespace gonio::drivers {
namespace {

constexpr std::uint16_t kAnyPort = 502;        // never used: the socket is handed over
constexpr std::uint32_t kNoWaitMicros = 1000;  // a received frame is there already; 0 would mean half a second

struct FreeModbus {
  void operator()(modbus_t* context) const { modbus_free(context); }
};

// A reply that says no, in step with its request; libmodbus numbers these after the exception codes of the standard.
bool is_exception_reply(int error) {
  return error >= EMBXILFUN && error <= EMBXGTAR;
}

ErrorCode code_of(int error) {
  if (is_exception_reply(error)) return ErrorCode::DeviceRefused;
  switch (error) {
    case ETIMEDOUT:
      return ErrorCode::TimedOut;
    case EMBBADCRC:
    case EMBBADDATA:
    case EMBBADEXC:
    case EMBUNKEXC:
    case EMBMDATA:
    case EMBBADSLAVE:
      return ErrorCode::BadReply;
    default:
      return ErrorCode::Unreachable;
  }
}

Error error_of(int error) {
  return {.code = code_of(error), .device = {}, .tried = {}, .seen = modbus_strerror(error), .limit = {}};
}

// What libmodbus' functions return: the number of registers, or -1.
Result<void> outcome(int done, int expected) {
  if (done == expected) return {};
  return failure(error_of(done < 0 ? errno : EMBBADDATA));
}

char letter_of(Parity parity) {
  constexpr std::array<char, 3> kLetters{'N', 'E', 'O'};
  return kLetters.at(static_cast<std::size_t>(parity));
}

}  // namespace

struct ModbusContext::Impl {
  explicit Impl(modbus_t* made, std::uint8_t unit_id) : context(made) {
    assert(context != nullptr);
    modbus_set_error_recovery(context.get(), MODBUS_ERROR_RECOVERY_NONE);
    modbus_set_slave(context.get(), unit_id);
    // Off: the reply timeout then bounds the whole reply, however slowly its bytes trickle in.
    modbus_set_byte_timeout(context.get(), 0, 0);
  }
  std::unique_ptr<modbus_t, FreeModbus> context;
  ModbusUnit unit;
};

ModbusContext::ModbusContext(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ModbusContext::ModbusContext(ModbusContext&&) noexcept = default;
ModbusContext& ModbusContext::operator=(ModbusContext&&) noexcept = default;
ModbusContext::~ModbusContext() = default;

ModbusContext ModbusContext::tcp(std::uint8_t unit_id, Duration reply_timeout) {
  auto impl = std::make_unique<Impl>(modbus_new_tcp("127.0.0.1", kAnyPort), unit_id);
  const auto whole = std::chrono::floor<std::chrono::seconds>(reply_timeout);
  const auto rest = std::chrono::ceil<std::chrono::microseconds>(reply_timeout - whole);
  modbus_set_response_timeout(impl->context.get(), static_cast<std::uint32_t>(whole.count()),
                              static_cast<std::uint32_t>(rest.count()));
  return ModbusContext(std::move(impl));
}

ModbusContext ModbusContext::rtu(const SerialLine& line, std::uint8_t unit_id) {
  constexpr int kDataBits = 8;
  auto impl = std::make_unique<Impl>(
      modbus_new_rtu(line.device.c_str(), line.baud, letter_of(line.parity), kDataBits, line.stop_bits), unit_id);
  modbus_set_response_timeout(impl->context.get(), 0, kNoWaitMicros);
  return ModbusContext(std::move(impl));
}

void ModbusContext::use_socket(int descriptor) {
  modbus_set_socket(impl_->context.get(), descriptor);
}

void ModbusContext::select(const ModbusUnit& unit) {
  impl_->unit = unit;
  modbus_set_slave(impl_->context.get(), unit.unit_id);
}

Result<void> ModbusContext::read_registers(std::uint16_t first, std::span<std::uint16_t> into) {
  const int count = static_cast<int>(into.size());
  const auto read =
      impl_->unit.reads == stage::ReadFunction::Input ? modbus_read_input_registers : modbus_read_registers;
  return outcome(read(impl_->context.get(), first, count, into.data()), count);
}

Result<void> ModbusContext::write_registers(std::uint16_t first, std::span<const std::uint16_t> words) {
  const int count = static_cast<int>(words.size());
  const bool is_single = count == 1 && impl_->unit.writes == stage::WriteFunction::Single;
  return outcome(is_single ? modbus_write_register(impl_->context.get(), first, words.front())
                           : modbus_write_registers(impl_->context.get(), first, count, words.data()),
                 count);
}

Result<void> ModbusContext::write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                           std::uint16_t read_first, std::span<std::uint16_t> into) {
  const int count = static_cast<int>(into.size());
  return outcome(modbus_write_and_read_registers(impl_->context.get(), write_first, static_cast<int>(words.size()),
                                                 words.data(), read_first, count, into.data()),
                 count);
}

Result<int> ModbusContext::open_line() {
  if (modbus_connect(impl_->context.get()) != 0) {
    Error error = error_of(errno);
    error.code = ErrorCode::Unreachable;
    return failure(std::move(error));
  }
  const int descriptor = modbus_get_socket(impl_->context.get());
  if (descriptor < FD_SETSIZE) return descriptor;
  close_line();
  return failure({.code = ErrorCode::Unreachable,
                  .device = {},
                  .tried = {},
                  .seen = fmt::format("file descriptor {}", descriptor),
                  .limit = fmt::format("below {}: too many files are open", FD_SETSIZE)});
}

void ModbusContext::close_line() {
  modbus_close(impl_->context.get());
}

Result<void> ModbusContext::send(std::span<const std::uint8_t> unit_and_pdu) {
  std::vector<std::uint8_t> frame(unit_and_pdu.begin(), unit_and_pdu.end());  // libmodbus takes no const
  constexpr int kCrcBytes = 2;
  const int sent = modbus_send_raw_request(impl_->context.get(), frame.data(), static_cast<int>(frame.size()));
  if (sent == static_cast<int>(frame.size()) + kCrcBytes) return {};
  Error error = error_of(sent < 0 ? errno : EIO);
  error.code = ErrorCode::Unreachable;
  return failure(std::move(error));
}

Result<std::vector<std::uint8_t>> ModbusContext::receive() {
  std::array<std::uint8_t, MODBUS_RTU_MAX_ADU_LENGTH> frame{};
  const int length = modbus_receive_confirmation(impl_->context.get(), frame.data());
  if (length < 0) return failure(error_of(errno));
  if (length < 4) {  // 0: a frame for somebody else, which libmodbus passes over
    return failure({.code = ErrorCode::BadReply,
                    .device = {},
                    .tried = {},
                    .seen = fmt::format("a frame of unit {}", frame[0]),
                    .limit = {}});
  }
  return std::vector<std::uint8_t>(frame.begin(), frame.begin() + length - 2);
}

}  // namespace gonio::drivers
