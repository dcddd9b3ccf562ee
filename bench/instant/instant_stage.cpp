#include "bench/instant/instant_stage.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <span>
#include <stdexcept>

namespace gonio::bench {
namespace {

constexpr int kRegisters = 256;
using stage::Axis;
using stage::AxisField;
using stage::Field;

}  // namespace

InstantStage::InstantStage() : registers_(modbus_mapping_new(0, 0, kRegisters, 0), modbus_mapping_free) {
  set(Field::Identity, stage::kIdentity);
  set(Field::MapVersion, stage::kMapVersion);
  set(Field::BootCounter, 1);
  set(Field::Status, bit(stage::StatusBit::Homed));
  for (const Axis axis : stage::kAllAxes) {
    stage::encode(std::span(registers_->tab_registers, kRegisters), 0, map_.at(axis, AxisField::Status),
                  bit(stage::AxisBit::Homed));
  }
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  const bool listens = ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
                       ::listen(listener_, 4) == 0 &&
                       ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  if (!listens) throw std::runtime_error("no port for the instant stage");
  port_ = ntohs(address.sin_port);
  acceptor_ = std::jthread([this] { accept(); });
}

InstantStage::~InstantStage() {
  ends_ = true;
  ::shutdown(listener_, SHUT_RDWR);
  acceptor_.join();
  for (const int socket : sockets_) ::shutdown(socket, SHUT_RDWR);
  threads_.clear();
  ::close(listener_);
}

void InstantStage::accept() {
  while (!ends_) {
    const int socket = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (socket < 0) continue;
    const int on = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    sockets_.push_back(socket);
    threads_.emplace_back([this, socket] { serve(socket); });
  }
}

void InstantStage::serve(int socket) {
  const Context context(modbus_new_tcp("127.0.0.1", port_), modbus_free);
  modbus_set_socket(context.get(), socket);
  std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> request{};
  while (!ends_) {
    const int size = modbus_receive(context.get(), request.data());
    if (size < 0) break;
    const std::lock_guard lock(mutex_);
    act_before_reading(std::span(request).first(static_cast<std::size_t>(size)));
    if (modbus_reply(context.get(), request.data(), size, registers_.get()) < 0) break;
    act();
  }
  modbus_close(context.get());
}

void InstantStage::set(Field field, std::int64_t value) {
  stage::encode(std::span(registers_->tab_registers, kRegisters), 0, map_.at(field), value);
}

std::int64_t InstantStage::get(Field field) const {
  return stage::decode(std::span<const std::uint16_t>(registers_->tab_registers, kRegisters), 0, map_.at(field));
}

// A request that writes and reads shows what came of the writing: the reply writes the same once more.
void InstantStage::act_before_reading(std::span<const std::uint8_t> request) {
  constexpr std::size_t kFunction = 7;
  constexpr std::size_t kWriteFirst = 12;
  constexpr std::size_t kWriteCount = 14;
  constexpr std::size_t kValues = 17;
  constexpr std::uint8_t kWriteAndRead = 0x17;
  if (request.size() < kValues || request[kFunction] != kWriteAndRead) return;
  const auto word = [&request](std::size_t at) {
    return static_cast<std::uint16_t>(request[at] << 8U | request[at + 1]);
  };
  const std::size_t first = word(kWriteFirst);
  const std::size_t count = word(kWriteCount);
  if (first + count > kRegisters || kValues + 2 * count > request.size()) return;
  for (std::size_t k = 0; k < count; ++k) registers_->tab_registers[first + k] = word(kValues + 2 * k);
  act();
}

// What was commanded since the last request.
void InstantStage::act() {
  const std::span registers(registers_->tab_registers, kRegisters);
  if (get(Field::MotionCommand) != 0) {
    const std::int64_t mask = get(Field::MotionMask);
    for (const Axis axis : stage::kAllAxes) {
      if ((mask >> stage::index_of(axis) & 1) == 0 || get(Field::MotionCommand) != stage::kCommandMove) continue;
      const std::int64_t target =
          stage::decode(std::span<const std::uint16_t>(registers), 0, map_.at(axis, AxisField::Target));
      stage::encode(registers, 0, map_.at(axis, AxisField::Encoder), target);
    }
    set(Field::AcceptedToken, get(Field::MotionToken));
    set(Field::MotionCommand, 0);
  }
  set(Field::SourceShutter, get(Field::SourceShutterCommand));
  set(Field::DetectorShutter, get(Field::DetectorShutterCommand));
}

bool InstantStage::is_lit() {
  const std::lock_guard lock(mutex_);
  return get(Field::DetectorShutter) == 1;
}

void InstantStage::count_gate() {
  const std::lock_guard lock(mutex_);
  const std::span registers(registers_->tab_registers, kRegisters);
  for (const Axis axis : stage::kAllAxes) {
    const std::int64_t place =
        stage::decode(std::span<const std::uint16_t>(registers), 0, map_.at(axis, AxisField::Encoder));
    stage::encode(registers, 0, map_.at(axis, AxisField::GateOpenEncoder), place);
    stage::encode(registers, 0, map_.at(axis, AxisField::GateCloseEncoder), place);
  }
  set(Field::GateMonitorMean, static_cast<std::int64_t>(1.0 / map_.monitor_scale));
  set(Field::GateMonitorSamples, 2);
  set(Field::GateCount, get(Field::GateCount) + 1);
}

}  // namespace gonio::bench
