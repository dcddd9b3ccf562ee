#include "bench/wires/stop_witness.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "protocol/stage/register_map.h"
#include "sim/wires/rtu_frame.h"

namespace gonio::bench {
namespace {

constexpr Duration kPatience = std::chrono::seconds(10);
constexpr std::size_t kMbapHead = 6;  // up to the length; the unit follows
constexpr std::uint8_t kWriteSeveral = 0x10;
constexpr std::size_t kEcho = 5;  // of a write: function, address, count

void write_all(int descriptor, std::span<const std::uint8_t> bytes, bool is_serial) {
  [[maybe_unused]] const ssize_t n = is_serial ? ::write(descriptor, bytes.data(), bytes.size())
                                               : ::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

bool is_halt(std::span<const std::uint8_t> pdu) {
  static const std::uint16_t at = stage::own_register_map().halt_block().first;
  return pdu.size() > kEcho && pdu[0] == kWriteSeveral && pdu[1] * 256 + pdu[2] == at;
}

}  // namespace

StopWitness::StopWitness(const std::string& line) : is_serial_(!line.empty()), wake_up_(sim::make_wake_up().value()) {
  if (is_serial_) {
    pty_ = sim::SerialPty::open(line).value();
    peers_.push_back(std::make_unique<Peer>());
  } else {
    listener_ = sim::listen_tcp("127.0.0.1", 0).value();
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

StopWitness::~StopWitness() {
  thread_.request_stop();
  sim::wake(wake_up_);
}

std::uint16_t StopWitness::port() const {
  return sim::port_of(listener_);
}

void StopWitness::expect_halt() {
  const std::lock_guard lock(mutex_);
  halt_.reset();
}

std::optional<Instant> StopWitness::halt_came() {
  std::unique_lock lock(mutex_);
  came_.wait_for(lock, kPatience, [&] { return halt_.has_value(); });
  return halt_;
}

void StopWitness::note_halt() {
  const std::lock_guard lock(mutex_);
  if (!halt_) halt_ = clock_.now();
  came_.notify_all();
}

void StopWitness::note_other() {
  const std::lock_guard lock(mutex_);
  ++others_;
  came_.notify_all();
}

bool StopWitness::await_other() {
  std::unique_lock lock(mutex_);
  const std::uint64_t before = others_;
  return came_.wait_for(lock, kPatience, [&] { return others_ != before; });
}

void StopWitness::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::vector<pollfd> watched{{wake_up_.get(), POLLIN, 0}};
    if (is_serial_) watched.push_back({pty_->descriptor(), POLLIN, 0});
    for (const auto& peer : peers_) {
      if (!is_serial_) watched.push_back({peer->socket.get(), POLLIN, 0});
    }
    const std::size_t known = peers_.size();
    if (!is_serial_) watched.push_back({listener_.get(), POLLIN, 0});
    if (::poll(watched.data(), watched.size(), -1) < 0) continue;
    sim::drain(wake_up_);
    for (std::size_t k = 0; k < known; ++k) {
      if (watched[1 + k].revents != 0) take(*peers_[k], watched[1 + k].fd);
    }
    if (is_serial_ || (watched.back().revents & POLLIN) == 0) continue;
    auto peer = std::make_unique<Peer>();
    peer->socket = sim::FileDescriptor(::accept(listener_.get(), nullptr, nullptr));
    peers_.push_back(std::move(peer));
  }
}

void StopWitness::take(Peer& peer, int descriptor) {
  std::array<std::uint8_t, 512> bytes{};
  const ssize_t n = ::read(descriptor, bytes.data(), bytes.size());
  if (n <= 0 && !is_serial_) {
    std::erase_if(peers_, [&](const auto& one) { return one.get() == &peer; });
    return;
  }
  peer.received.insert(peer.received.end(), bytes.begin(), bytes.begin() + std::max<ssize_t>(n, 0));
  hear(peer, descriptor, is_serial_ ? 0 : kMbapHead);
}

// Whole requests from the front.
void StopWitness::hear(Peer& peer, int descriptor, std::size_t head) {
  for (;;) {
    const std::span<const std::uint8_t> all(peer.received);
    std::optional<std::size_t> size;
    if (is_serial_) size = sim::rtu_request_length(all);
    if (!is_serial_ && all.size() > head) size = head + all[4] * 256U + all[5];
    if (!size || all.size() < *size) return;
    const auto frame = all.first(*size);
    const auto pdu = frame.subspan(head + 1, *size - head - 1 - (is_serial_ ? 2 : 0));
    if (is_halt(pdu)) {
      note_halt();
      std::vector<std::uint8_t> reply(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(head + 1 + kEcho));
      if (!is_serial_) reply[5] = static_cast<std::uint8_t>(1 + kEcho);
      if (is_serial_) reply = sim::rtu_frame(frame[0], pdu.first(kEcho));
      write_all(descriptor, reply, is_serial_);
    } else {
      note_other();
    }
    peer.received.erase(peer.received.begin(), peer.received.begin() + static_cast<std::ptrdiff_t>(*size));
  }
}

}  // namespace gonio::bench
