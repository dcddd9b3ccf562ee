#include "bench/wires/stage_tap.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "protocol/stage/register_map.h"

namespace gonio::bench {
namespace {

constexpr Duration kTapPatience = std::chrono::seconds(10);
constexpr std::size_t kHead = 6;  // up to the length; the unit follows
constexpr std::size_t kFunctionAt = 7;
constexpr std::uint8_t kReads = 0x03;
constexpr std::uint8_t kWritesSeveral = 0x10;
constexpr std::uint8_t kWritesAndReads = 0x17;

// The first register that a request writes, whichever function it uses.
std::optional<int> written_at(std::span<const std::uint8_t> frame) {
  const auto word = [frame](std::size_t at) { return frame[at] * 256 + frame[at + 1]; };
  if (frame.size() > 13 && frame[kFunctionAt] == kWritesSeveral) return word(8);
  if (frame.size() > 17 && frame[kFunctionAt] == kWritesAndReads) return word(12);
  return std::nullopt;
}

bool reads(std::span<const std::uint8_t> frame) {
  return frame.size() > kFunctionAt && (frame[kFunctionAt] == kReads || frame[kFunctionAt] == kWritesAndReads);
}

void send_at_once(const sim::FileDescriptor& to, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::send(to.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n <= 0) return;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
}

void without_delay(const sim::FileDescriptor& socket) {
  const int on = 1;
  ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

sim::FileDescriptor connected_to(std::uint16_t port) {
  sim::FileDescriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0) socket.reset();
  without_delay(socket);
  return socket;
}

}  // namespace

StageTap::StageTap(std::uint16_t stage_port)
    : stage_port_(stage_port),
      listener_(sim::listen_tcp("127.0.0.1", 0).value()),
      wake_up_(sim::make_wake_up().value()),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

StageTap::~StageTap() {
  thread_.request_stop();
  sim::wake(wake_up_);
}

void StageTap::expect_halt() {
  const std::lock_guard lock(mutex_);
  halt_.reset();
  motions_since_halt_ = 0;
}

std::optional<Instant> StageTap::halt_came() {
  std::unique_lock lock(mutex_);
  came_.wait_for(lock, kTapPatience, [&] { return halt_.has_value(); });
  return halt_;
}

long StageTap::motions_since_halt() const {
  const std::lock_guard lock(mutex_);
  return motions_since_halt_;
}

void StageTap::keep_back(bool on) {
  const std::lock_guard lock(mutex_);
  keeps_back_ = on;
  kept_back_ = 0;
}

bool StageTap::await_kept_back() {
  std::unique_lock lock(mutex_);
  return came_.wait_for(lock, kTapPatience, [&] { return kept_back_ > 0; });
}

void StageTap::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::vector<pollfd> watched{{wake_up_.get(), POLLIN, 0}, {listener_.get(), POLLIN, 0}};
    for (const auto& pair : pairs_) {
      watched.push_back({pair->daemon.get(), POLLIN, 0});
      watched.push_back({pair->stage.get(), POLLIN, 0});
    }
    if (::poll(watched.data(), watched.size(), -1) < 0) continue;
    sim::drain(wake_up_);
    const std::size_t known = pairs_.size();
    for (std::size_t k = 0; k < known; ++k) {
      if (watched[2 + 2 * k].revents != 0) take(*pairs_[k]);
      if (watched[3 + 2 * k].revents != 0) hand_back(*pairs_[k]);
    }
    if ((watched[1].revents & POLLIN) != 0) accept_one();
    std::erase_if(pairs_, [](const auto& pair) { return pair->is_over; });
  }
}

void StageTap::accept_one() {
  auto pair = std::make_unique<Pair>();
  pair->daemon = sim::FileDescriptor(::accept(listener_.get(), nullptr, nullptr));
  pair->stage = connected_to(stage_port_);
  if (pair->daemon.get() < 0 || pair->stage.get() < 0) return;
  without_delay(pair->daemon);
  pairs_.push_back(std::move(pair));
}

void StageTap::hand_back(Pair& pair) {
  std::array<std::uint8_t, 4096> bytes{};
  const ssize_t n = ::recv(pair.stage.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  pair.is_over = pair.is_over || n == 0;
  if (n > 0) send_at_once(pair.daemon, std::span(bytes).first(static_cast<std::size_t>(n)));
}

void StageTap::take(Pair& pair) {
  std::array<std::uint8_t, 4096> bytes{};
  const ssize_t n = ::recv(pair.daemon.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  pair.is_over = pair.is_over || n == 0;
  if (n <= 0) return;
  pair.received.insert(pair.received.end(), bytes.begin(), bytes.begin() + n);
  for (;;) {
    const std::span<const std::uint8_t> all(pair.received);
    if (all.size() < kHead) return;
    const std::size_t size = kHead + all[4] * 256U + all[5];
    if (all.size() < size) return;
    hand_on(pair, all.first(size));
    pair.received.erase(pair.received.begin(), pair.received.begin() + static_cast<std::ptrdiff_t>(size));
  }
}

void StageTap::hand_on(Pair& pair, std::span<const std::uint8_t> frame) {
  static const stage::RegisterMap map = stage::own_register_map();
  {
    const std::lock_guard lock(mutex_);
    const auto at = written_at(frame);
    if (at == map.halt_block().first && !halt_) halt_ = clock_.now();
    if (at == map.motion_block().first && halt_) ++motions_since_halt_;
    if (keeps_back_ && reads(frame)) {
      ++kept_back_;
      came_.notify_all();
      return;
    }
    came_.notify_all();
  }
  send_at_once(pair.stage, frame);
}

}  // namespace gonio::bench
