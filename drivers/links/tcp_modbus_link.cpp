#include "drivers/links/tcp_modbus_link.h"

#include <fmt/format.h>
#include <sys/socket.h>

#include <atomic>
#include <mutex>
#include <utility>

#include "drivers/links/gave_way.h"
#include "drivers/links/modbus_context.h"
#include "drivers/links/tcp_socket.h"

namespace gonio::drivers {

struct TcpModbusLink::Impl {
  explicit Impl(TcpModbusConfig the_config)
      : config(std::move(the_config)), context(ModbusContext::tcp(config.unit_id, config.reply_timeout)) {}

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
    context.use_socket(socket.descriptor());
    is_connected = true;
    return {};
  }

  void close() {
    TcpSocket closing;
    const std::lock_guard lock(socket_mutex);
    std::swap(closing, socket);
    is_connected = false;
  }

  // Runs one transaction of the context's with a unit. `tried` says what it was, when it failed: words take longer to
  // make than a register to read.
  template <class Tried, class Call>
  Result<void> transact(const ModbusUnit& unit, Tried tried, Call call) {
    Result<void> done = ensure_connected();
    if (done && is_interrupted.exchange(false)) {
      close();
      done = failure({.code = ErrorCode::Unreachable, .device = "stage", .tried = tried(), .seen = kGaveWay});
    }
    if (!done) return done;
    context.select(unit);
    done = call(context);
    if (done) return done;
    is_interrupted = false;  // if it was, this call has given way
    Error& error = done.error();
    if (error.code != ErrorCode::DeviceRefused) close();
    error.device = "stage";
    error.tried = tried();
    if (error.code == ErrorCode::TimedOut) {
      error.seen = "no complete reply";
      error.limit = fmt::format("{:.0f} ms", in_seconds(config.reply_timeout) * 1e3);
    }
    return done;
  }

  // Remembered as well: a socket that is not connected yet cannot be shut down, and would go on to wait for a reply.
  void interrupt() {
    const std::lock_guard lock(socket_mutex);
    is_interrupted = true;
    if (socket.descriptor() >= 0) ::shutdown(socket.descriptor(), SHUT_RDWR);
  }

  TcpModbusConfig config;
  ModbusContext context;
  std::mutex socket_mutex;  ///< guards the descriptor's life against `interrupt`
  TcpSocket socket;
  bool is_connected = false;
  std::atomic<bool> is_interrupted{false};
};

/// One unit over the connection of a link.
class TcpModbusLink::Face final : public ModbusLink {
 public:
  Face(Impl& impl, const ModbusUnit& unit) : impl_(impl), unit_(unit) {}

  Result<void> read_registers(std::uint16_t first, std::span<std::uint16_t> into) override {
    return impl_.transact(
        unit_, [&] { return fmt::format("read {} registers from {}", into.size(), first); },
        [&](ModbusContext& context) { return context.read_registers(first, into); });
  }
  Result<void> write_registers(std::uint16_t first, std::span<const std::uint16_t> words) override {
    return impl_.transact(
        unit_, [&] { return fmt::format("write {} registers from {}", words.size(), first); },
        [&](ModbusContext& context) { return context.write_registers(first, words); });
  }
  Result<void> write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words, std::uint16_t read_first,
                              std::span<std::uint16_t> into) override {
    return impl_.transact(
        unit_,
        [&] {
          return fmt::format("write {} registers from {} and read {} from {}", words.size(), write_first, into.size(),
                             read_first);
        },
        [&](ModbusContext& context) { return context.write_and_read(write_first, words, read_first, into); });
  }
  void resync() override { impl_.close(); }
  void interrupt() override { impl_.interrupt(); }

 private:
  Impl& impl_;
  const ModbusUnit unit_;
};

TcpModbusLink::TcpModbusLink(TcpModbusConfig config)
    : impl_(std::make_unique<Impl>(std::move(config))),
      own_(std::make_unique<Face>(*impl_, ModbusUnit{.unit_id = impl_->config.unit_id})) {}
TcpModbusLink::~TcpModbusLink() = default;

Result<void> TcpModbusLink::read_registers(std::uint16_t first, std::span<std::uint16_t> into) {
  return own_->read_registers(first, into);
}

Result<void> TcpModbusLink::write_registers(std::uint16_t first, std::span<const std::uint16_t> words) {
  return own_->write_registers(first, words);
}

Result<void> TcpModbusLink::write_and_read(std::uint16_t write_first, std::span<const std::uint16_t> words,
                                           std::uint16_t read_first, std::span<std::uint16_t> into) {
  return own_->write_and_read(write_first, words, read_first, into);
}

void TcpModbusLink::resync() {
  own_->resync();
}

void TcpModbusLink::interrupt() {
  own_->interrupt();
}

std::unique_ptr<ModbusLink> TcpModbusLink::for_unit(const ModbusUnit& unit) {
  return std::make_unique<Face>(*impl_, unit);
}

}  // namespace gonio::drivers
