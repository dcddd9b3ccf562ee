#include "bench/wires/stage_tap.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "protocol/stage/register_map.h"
#include "sim/wires/rtu_frame.h"

namespace gonio::bench {
namespace {

constexpr Duration kTapPatience = std::chrono::seconds(10);
constexpr std::size_t kHead = 6;  // of a frame on TCP, up to the length; the unit follows
constexpr std::uint8_t kReads = 0x03;
constexpr std::uint8_t kWritesSeveral = 0x10;
constexpr std::uint8_t kWritesAndReads = 0x17;

// The first register that a request writes, whichever function it uses. The PDU begins with the function.
std::optional<int> written_at(std::span<const std::uint8_t> pdu) {
  const auto word = [pdu](std::size_t at) { return pdu[at] * 256 + pdu[at + 1]; };
  if (pdu.size() > 6 && pdu[0] == kWritesSeveral) return word(1);
  if (pdu.size() > 10 && pdu[0] == kWritesAndReads) return word(5);
  return std::nullopt;
}

bool reads(std::span<const std::uint8_t> pdu) {
  return !pdu.empty() && (pdu[0] == kReads || pdu[0] == kWritesAndReads);
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

StageTap::StageTap(const std::string& line, const std::string& stage_line)
    : line_(sim::SerialPty::open(line).value()), wake_up_(sim::make_wake_up().value()) {
  auto pair = std::make_unique<Pair>();
  pair->daemon = sim::FileDescriptor(::dup(line_->descriptor()));
  pair->stage = sim::FileDescriptor(::open(stage_line.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (pair->stage.get() < 0) throw std::runtime_error("cannot open " + stage_line);
  pairs_.push_back(std::move(pair));
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

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
    // poll passes over a descriptor that is not there: the listener's on a serial line.
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

void StageTap::hand_back(Pair& pair) const {
  std::array<std::uint8_t, 4096> bytes{};
  const ssize_t n = ::read(pair.stage.get(), bytes.data(), bytes.size());
  pair.is_over = pair.is_over || n == 0;
  if (n > 0) send(pair.daemon, std::span(bytes).first(static_cast<std::size_t>(n)));
}

void StageTap::take(Pair& pair) {
  std::array<std::uint8_t, 4096> bytes{};
  const ssize_t n = ::read(pair.daemon.get(), bytes.data(), bytes.size());
  pair.is_over = pair.is_over || n == 0;
  if (n <= 0) return;
  pair.received.insert(pair.received.end(), bytes.begin(), bytes.begin() + n);
  for (;;) {
    const std::span<const std::uint8_t> all(pair.received);
    const auto size = request_length(all);
    if (!size || all.size() < *size) return;
    hand_on(pair, all.first(*size));
    pair.received.erase(pair.received.begin(), pair.received.begin() + static_cast<std::ptrdiff_t>(*size));
  }
}

std::optional<std::size_t> StageTap::request_length(std::span<const std::uint8_t> begin) const {
  if (line_) return sim::rtu_request_length(begin);
  if (begin.size() < kHead) return std::nullopt;
  return kHead + begin[4] * 256U + begin[5];
}

void StageTap::send(const sim::FileDescriptor& to, std::span<const std::uint8_t> bytes) const {
  while (!bytes.empty()) {
    const ssize_t n = line_ ? ::write(to.get(), bytes.data(), bytes.size())
                            : ::send(to.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n <= 0) return;
    bytes = bytes.subspan(static_cast<std::size_t>(n));
  }
}

void StageTap::hand_on(Pair& pair, std::span<const std::uint8_t> frame) {
  static const stage::RegisterMap map = stage::own_register_map();
  const auto pdu = frame.subspan(line_ ? 1 : kHead + 1);
  {
    const std::lock_guard lock(mutex_);
    const auto at = written_at(pdu);
    if (at == map.halt_block().first && !halt_) halt_ = clock_.now();
    if (at == map.motion_block().first && halt_) ++motions_since_halt_;
    if (keeps_back_ && reads(pdu)) {
      ++kept_back_;
      came_.notify_all();
      return;
    }
    came_.notify_all();
  }
  send(pair.stage, frame);
}

}  // namespace gonio::bench
