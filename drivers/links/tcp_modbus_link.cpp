// The adapter of libmodbus: nothing else in this room knows it.
#include "drivers/links/tcp_modbus_link.h"

#include <fmt/format.h>
#include <modbus/modbus.h>
#include <sys/socket.h>

#include <cassert>
#include <cerrno>
#include <mutex>
#include <utility>

#include "drivers/links/tcp_socket.h"

namespace gonio::drivers {
namespace {

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

}  // namespace

struct TcpModbusLink::Impl {
  explicit Impl(TcpModbusConfig the_config) : config(std::move(the_config)) {
    // The address is never used: the socket is made here and handed over.
    context.reset(modbus_new_tcp("127.0.0.1", config.port));
    assert(context != nullptr);
    modbus_set_error_recovery(context.get(), MODBUS_ERROR_RECOVERY_NONE);
    modbus_set_slave(context.get(), config.unit_id);
    const auto whole = std::chrono::floor<std::chrono::seconds>(config.reply_timeout);
    const auto rest = std::chrono::ceil<std::chrono::microseconds>(config.reply_timeout - whole);
    modbus_set_response_timeout(context.get(), static_cast<std::uint32_t>(whole.count()),
                                static_cast<std::uint32_t>(rest.count()));
    // Off: the reply timeout then bounds the whole reply, however slowly its bytes trickle in.
    modbus_set_byte_timeout(context.get(), 0, 0);
  }

  // The descriptor is published before connecting, so that `interrupt` ends a connect as well.
  Result<void> ensure_connected() {
    if (is_connected) return {};
    auto made = TcpSocket::make(fmt::format("{}:{}", config.address, config.port));
    if (!made) return failure(std::move(made).error());
    {
      const std::lock_guard lock(socket_mutex);
      socket = std::move(*made);
    }
    if (auto connected = socket.connect(config.address, config.port, config.connect_timeout); !connected) {
      close();
      return connected;
    }
    modbus_set_socket(context.get(), socket.descriptor());
    is_connected = true;
    return {};
  }

  void close() {
    TcpSocket closing;
    const std::lock_guard lock(socket_mutex);
    std::swap(closing, socket);
    is_connected = false;
  }

  // Runs one transaction; `call` returns the number of registers or -1, as libmodbus does.
  template <class Call>
  Result<void> transact(std::string tried, int expected, Call call) {
    GONIO_TRY(ensure_connected());
    errno = 0;
    const int done = call(context.get());
    if (done == expected) return {};
    const int error = done < 0 ? errno : EMBBADDATA;
    if (!is_exception_reply(error)) close();
    Error failed{.code = code_of(error), .device = "stage", .tried = std::move(tried), .seen = modbus_strerror(error)};
    if (failed.code == ErrorCode::TimedOut) {
      failed.seen = "no complete reply";
      failed.limit = fmt::format("{:.0f} ms", in_seconds(config.reply_timeout) * 1e3);
    }
    return failure(std::move(failed));
  }

  TcpModbusConfig config;
  std::unique_ptr<modbus_t, FreeModbus> context;
  std::mutex socket_mutex;  ///< guards the descriptor's life against `interrupt`
  TcpSocket socket;
  bool is_connected = false;
};

TcpModbusLink::TcpModbusLink(TcpModbusConfig config) : impl_(std::make_unique<Impl>(std::move(config))) {}
TcpModbusLink::~TcpModbusLink() = default;

Result<void> TcpModbusLink::read_registers(std::uint16_t first, std::span<std::uint16_t> into) {
  const int count = static_cast<int>(into.size());
  return impl_->transact(fmt::format("read {} registers from {}", count, first), count,
                         [&](modbus_t* m) { return modbus_read_registers(m, first, count, into.data()); });
}

Result<void> TcpModbusLink::write_registers(std::uint16_t first, std::span<const std::uint16_t> words) {
  const int count = static_cast<int>(words.size());
  return impl_->transact(fmt::format("write {} registers from {}", count, first), count, [&](modbus_t* m) {
    return count == 1 ? modbus_write_register(m, first, words.front())
                      : modbus_write_registers(m, first, count, words.data());
  });
}

Result<void> TcpModbusLink::write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                           std::uint16_t read_first, std::span<std::uint16_t> into) {
  const int count = static_cast<int>(into.size());
  return impl_->transact(
      fmt::format("write {} registers from {} and read {} from {}", words.size(), write_first, count, read_first),
      count, [&](modbus_t* m) {
        return modbus_write_and_read_registers(m, write_first, static_cast<int>(words.size()), words.data(), read_first,
                                               count, into.data());
      });
}

void TcpModbusLink::resync() {
  impl_->close();
}

void TcpModbusLink::interrupt() {
  const std::lock_guard lock(impl_->socket_mutex);
  if (impl_->socket.descriptor() >= 0) ::shutdown(impl_->socket.descriptor(), SHUT_RDWR);
}

}  // namespace gonio::drivers
