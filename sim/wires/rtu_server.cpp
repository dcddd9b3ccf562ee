#include "sim/wires/rtu_server.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

#include "base/units.h"
#include "sim/wires/rtu_frame.h"
#include "sim/wires/sockets.h"

namespace gonio::sim {
namespace {

// 3.5 characters by the standard. A process is not a UART: bytes that were sent together may be seen this far apart.
constexpr Duration kStopped = std::chrono::milliseconds(50);
constexpr std::size_t kMostToSend = 64;
constexpr int kBitsAByte = 11;

}  // namespace

Result<std::unique_ptr<RtuServer>> RtuServer::start(LiveInstrument& instrument, const std::string& link,
                                                    RtuTiming timing) {
  auto wake_up = make_wake_up();
  if (!wake_up) return failure(std::move(wake_up).error());
  auto reply = ModbusReply::make();
  if (!reply) return failure(std::move(reply).error());
  auto pty = SerialPty::open(link);
  if (!pty) return failure(std::move(pty).error());
  std::unique_ptr<RtuServer> server(
      new RtuServer(instrument, link, timing, *std::move(wake_up), *std::move(reply), *std::move(pty)));
  server->thread_ = std::jthread([s = server.get()](const std::stop_token& stop) { s->run(stop); });
  return server;
}

RtuServer::RtuServer(LiveInstrument& instrument, std::string link, RtuTiming timing, FileDescriptor wake_up,
                     ModbusReply reply, SerialPty pty)
    : instrument_(instrument),
      link_(std::move(link)),
      timing_(timing),
      wake_up_(std::move(wake_up)),
      reply_(std::move(reply)),
      pty_(std::move(pty)) {}

RtuServer::~RtuServer() {
  thread_.request_stop();
  wake(wake_up_);
  thread_.join();
  ::unlink(link_.c_str());
}

void RtuServer::set_refusing(bool on) {
  is_refusing_ = on;
  wake(wake_up_);
}

Duration RtuServer::time_of(std::size_t bytes) const {
  return seconds(static_cast<double>(bytes) * kBitsAByte / timing_.baud);
}

void RtuServer::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::array<pollfd, 2> watched{{{wake_up_.get(), POLLIN, 0}, {pty_ ? pty_->descriptor() : -1, POLLIN, 0}}};
    ::poll(watched.data(), watched.size(), patience_ms(clock_.now()));
    drain(wake_up_);
    plug();
    if (!pty_) continue;
    if ((watched[1].revents & POLLIN) != 0) receive();
    const Instant now = clock_.now();
    take_what_stopped(now);
    send_due(now);
  }
}

// Until a reply is due, a torn request has stopped for good, or it is time to look whether the adapter is back; -1 when
// nothing is under way.
int RtuServer::patience_ms(Instant now) const {
  if (reopens_) return 0;
  Instant next = is_pulled_ ? now + kStopped : Instant::max();
  if (!to_send_.empty()) next = to_send_.front().due;
  if (!received_.empty()) next = std::min(next, last_byte_ + kStopped);
  if (next == Instant::max()) return -1;
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(std::max(next - now, Duration::zero()));
  return static_cast<int>(std::min<std::int64_t>(left.count(), 3'600'000));
}

bool RtuServer::refuses() {
  if (!is_pulled_) return is_refusing_;
  is_pulled_ = instrument_.with([](LiveInstrument::Parts& parts) {
    return parts.instrument.faults().active(FaultKind::StageRefuse, parts.now) != nullptr;
  });
  return is_refusing_ || is_pulled_;
}

// Follows `set_refusing` and the faults. A terminal that cannot be made is tried again at the next wake-up.
void RtuServer::plug() {
  const bool is_out = refuses();
  if (std::exchange(reopens_, false)) pty_.reset();
  if (is_out == !pty_.has_value()) return;
  received_.clear();
  to_send_.clear();
  if (is_out) {
    pty_.reset();
    ::unlink(link_.c_str());
  } else if (auto pty = SerialPty::open(link_)) {
    pty_.emplace(*std::move(pty));
  }
}

void RtuServer::receive() {
  std::array<std::uint8_t, 2048> bytes{};
  const ssize_t n = ::read(pty_->descriptor(), bytes.data(), bytes.size());
  if (n <= 0) return;
  received_.insert(received_.end(), bytes.begin(), bytes.begin() + n);
  last_byte_ = clock_.now();
  take_requests();
}

void RtuServer::take_requests() {
  while (const auto length = rtu_request_length(received_)) {
    if (*length > kLongestRtuFrame || received_.size() < *length) return;
    answer(std::span(received_).first(*length));
    received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(*length));
  }
}

// A silence ends a frame, of whatever length: an unknown function is answered, a torn frame is not.
void RtuServer::take_what_stopped(Instant now) {
  if (received_.empty() || now - last_byte_ < kStopped) return;
  answer(received_);
  received_.clear();
}

void RtuServer::answer(std::span<const std::uint8_t> frame) {
  const std::uint8_t unit = frame.front();
  constexpr std::uint8_t kLastUnit = 247;  // Modbus over Serial Line V1.02, 2.2
  const bool is_ours =
      has_good_crc(frame) && frame.size() <= kLongestRtuFrame && unit <= kLastUnit &&
      instrument_.with([unit](LiveInstrument::Parts& parts) { return parts.units.unit(unit) != nullptr; });
  if (!is_ours) return;
  ++requests_;
  if (is_silent_ || to_send_.size() >= kMostToSend) return;
  const auto pdu = frame.subspan(1, frame.size() - 3);
  std::vector<std::uint8_t> answered;
  const ExchangeFate fate = instrument_.with([&](LiveInstrument::Parts& parts) {
    ExchangeFate asked = fate_of_exchange(parts, pdu);
    if (asked.is_silent || asked.is_refused) return asked;
    answered = asked.is(FaultKind::ReplyException) ? exception_pdu(pdu, asked.fault->code())
                                                   : reply_.answer_pdu(unit, pdu, parts.units, parts.now);
    return asked;
  });
  is_pulled_ |= fate.is_refused;
  if (answered.empty()) return;
  auto bytes = rtu_frame(unit, answered);
  FaultyReply out{.bytes = bytes};
  if (fate.fault) out = spoil_rtu(*fate.fault, bytes, last_look_);
  if (exchange_kind(pdu, instrument_.scene().stage.registers) == ExchangeKind::Look) last_look_ = std::move(bytes);
  reopens_ |= out.resets;
  if (!out.bytes.empty()) put_out(time_of(frame.size() + out.bytes.size()) + timing_.turnaround + out.late, out.bytes);
}

void RtuServer::put_out(Duration after, std::vector<std::uint8_t> bytes) {
  const Instant due = clock_.now() + after;
  const auto later = [](Instant at, const Outgoing& other) { return at < other.due; };
  to_send_.insert(std::upper_bound(to_send_.begin(), to_send_.end(), due, later), {due, std::move(bytes)});
}

// What the terminal does not take is lost: nobody reads.
void RtuServer::send_due(Instant now) {
  while (!to_send_.empty() && to_send_.front().due <= now) {
    const auto& bytes = to_send_.front().bytes;
    [[maybe_unused]] const ssize_t n = ::write(pty_->descriptor(), bytes.data(), bytes.size());
    to_send_.pop_front();
  }
}

}  // namespace gonio::sim
