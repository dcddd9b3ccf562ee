#include "drivers/links/rtu_line.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "drivers/links/gave_way.h"

namespace gonio::drivers {
namespace {

constexpr std::size_t kCrcBytes = 2;
constexpr std::size_t kUnitAndCrc = 1 + kCrcBytes;
constexpr int kBitsAByte = 11;      // start, 8 data, parity or a second stop, stop
constexpr int kSettleTimeouts = 4;  // a line that is not quiet by then is not ours
constexpr Duration kUrgentQuiet = std::chrono::milliseconds(10);
constexpr Duration kShortestLook = std::chrono::microseconds(100);

Error plain(ErrorCode code, std::string seen, std::string limit = {}) {
  return {.code = code, .device = {}, .tried = {}, .seen = std::move(seen), .limit = std::move(limit)};
}

std::string milliseconds_text(Duration time) {
  return fmt::format("{:.0f} ms", in_seconds(time) * 1e3);
}

}  // namespace

RtuLine::RtuLine(RtuLineConfig config)
    : config_(std::move(config)),
      context_(ModbusContext::rtu(config_.line, config_.unit_id)),
      wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

RtuLine::~RtuLine() {
  close();
  if (wake_ >= 0) ::close(wake_);
}

Duration RtuLine::time_of(std::size_t bytes) const {
  return seconds(static_cast<double>(bytes) * kBitsAByte / config_.line.baud);
}

Duration RtuLine::silence() const {
  constexpr Duration kShortestSilence = std::chrono::microseconds(1750);
  return config_.silence.value_or(std::max(kShortestSilence, time_of(7) / 2));
}

Duration RtuLine::longest_exchange() const {
  return (kSettleTimeouts + 1) * config_.reply_timeout + config_.pause + time_of(256);
}

tl::unexpected<Error> RtuLine::broken(std::string seen) {
  close();
  return failure(plain(ErrorCode::Unreachable, std::move(seen)));
}

Result<void> RtuLine::open() {
  if (tty_ >= 0) return {};
  if (wake_ < 0) return failure(plain(ErrorCode::Unreachable, "no event descriptor: too many files are open"));
  Result<int> opened = context_.open_line();
  if (!opened) {
    opened.error().seen = fmt::format("{} cannot be opened: {}", config_.line.device, opened.error().seen);
    return failure(std::move(opened).error());
  }
  tty_ = *opened;
  if (::flock(tty_, LOCK_EX | LOCK_NB) != 0) return broken(config_.line.device + " is in use by another program");
  stirred_ = clock_.now() + config_.pause;  // who was here before us may have been killed in mid-exchange
  return {};
}

void RtuLine::close() {
  if (tty_ >= 0) context_.close_line();
  tty_ = -1;
}

void RtuLine::wake() {
  // An event descriptor that is full is readable already.
  [[maybe_unused]] const int done = ::eventfd_write(wake_, 1);
}

std::size_t RtuLine::reply_bytes(const ModbusRequest& request) {
  return request.reply_bytes() + kUnitAndCrc;
}

Result<std::size_t> RtuLine::waiting_bytes() {
  int count = 0;
  if (::ioctl(tty_, FIONREAD, &count) != 0) return broken(std::strerror(errno));
  return static_cast<std::size_t>(std::max(count, 0));
}

// Until then, until there are bytes when those are waited for, or until woken. Errors: Unreachable.
Result<void> RtuLine::wait(Instant until, bool for_bytes, const GivesWay& gives_way) {
  if (gives_way()) return failure(plain(ErrorCode::Unreachable, kGaveWay));
  const Duration left = std::max(until - clock_.now(), Duration::zero());
  const auto whole = std::chrono::floor<std::chrono::seconds>(left);
  const timespec patience{whole.count(), (left - whole).count()};
  std::array<pollfd, 2> watched{{{wake_, POLLIN, 0}, {tty_, POLLIN, 0}}};
  if (::ppoll(watched.data(), for_bytes ? 2 : 1, &patience, nullptr) <= 0) return {};
  if ((watched[0].revents & POLLIN) != 0) {
    eventfd_t count = 0;
    [[maybe_unused]] const int done = ::eventfd_read(wake_, &count);
    if (gives_way()) return failure(plain(ErrorCode::Unreachable, kGaveWay));
  }
  if ((watched[1].revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) return broken("the line hung up");
  return {};
}

Result<std::size_t> RtuLine::discard() {
  std::array<std::uint8_t, 512> nobodys{};
  std::size_t count = 0;
  for (;;) {
    const ssize_t n = ::read(tty_, nobodys.data(), nobodys.size());
    if (n > 0) count += static_cast<std::size_t>(n);
    if (n < 0 && errno != EAGAIN && errno != EINTR) return broken(std::strerror(errno));
    if (n <= 0) return count;
  }
}

void RtuLine::settle_debt(std::size_t bytes) {
  owed_ -= std::min(owed_.load(), bytes);
}

// Throws away what comes until nobody owes us anything, or nothing has come for long enough; then keeps the silence
// between frames. In haste it does not wait for more than a stop.
Result<void> RtuLine::settle(Haste haste, const GivesWay& gives_way) {
  const bool is_urgent = haste == Haste::Urgent;
  const Instant limit = clock_.now() + (is_urgent ? kUrgentWait : kSettleTimeouts * config_.reply_timeout);
  for (;;) {
    const auto came = discard();
    if (!came) return failure(came.error());
    if (*came > 0) stirred_ = clock_.now();
    settle_debt(*came);
    const Duration quiet = owed_ == 0 ? silence() : (is_urgent ? kUrgentQuiet : config_.reply_timeout);
    const Instant calm = stirred_ + quiet;
    const Instant now = clock_.now();
    if (now >= calm) {
      if (!is_urgent) settle_debt(owed_);
      return {};
    }
    if (now >= limit && is_urgent) return {};
    if (now >= limit) {
      return failure(plain(ErrorCode::Unreachable, "the line does not get quiet",
                           milliseconds_text(kSettleTimeouts * config_.reply_timeout)));
    }
    GONIO_TRY(wait(std::min(calm, limit), true, gives_way));
  }
}

Result<void> RtuLine::send(std::uint8_t unit, const ModbusRequest& request) {
  context_.select({.unit_id = unit});
  std::vector<std::uint8_t> frame{unit};
  frame.insert(frame.end(), request.pdu.begin(), request.pdu.end());
  if (auto sent = context_.send(frame); !sent) return broken(std::move(sent.error().seen));
  owe(reply_bytes(request));
  stirred_ = clock_.now() + time_of(request.pdu.size() + kUnitAndCrc);
  return {};
}

// Until so many bytes are there, or fewer that have stopped growing: an exception, a torn reply or somebody else's.
// Nothing is read yet: how far a reply has come only libmodbus shall know.
Result<void> RtuLine::await_reply(std::size_t bytes, const GivesWay& gives_way) {
  const Instant deadline = clock_.now() + config_.reply_timeout;
  std::size_t have = 0;
  for (;;) {
    const auto count = waiting_bytes();
    if (!count) return failure(count.error());
    const Instant now = clock_.now();
    if (*count > have) stirred_ = now;
    have = *count;
    if (have >= bytes || (have > 0 && now >= std::min(stirred_ + config_.pause, deadline))) return {};
    if (have == 0 && now >= deadline) {
      return failure(plain(ErrorCode::TimedOut, "no reply", milliseconds_text(config_.reply_timeout)));
    }
    // Once bytes have come the line would always look ready: the rest takes its time by the baud rate.
    const Instant look = have == 0 ? deadline : now + std::max(time_of(bytes - have), kShortestLook);
    GONIO_TRY(wait(std::min(look, deadline), have == 0, gives_way));
  }
}

Result<void> RtuLine::exchange(std::uint8_t unit, const ModbusRequest& request, std::span<std::uint16_t> into,
                               Haste haste, const GivesWay& gives_way) {
  GONIO_TRY(open());
  GONIO_TRY(settle(haste, gives_way));
  GONIO_TRY(send(unit, request));
  GONIO_TRY(await_reply(reply_bytes(request), gives_way));
  auto reply = context_.receive();
  if (!reply && reply.error().code == ErrorCode::Unreachable) return broken(std::move(reply.error().seen));
  if (!reply) {
    if (reply.error().code == ErrorCode::TimedOut) reply.error().seen = "no complete reply";
    return failure(std::move(reply).error());
  }
  if (reply->front() != unit) {
    return failure(
        plain(ErrorCode::BadReply, fmt::format("a frame of unit {}", reply->front()), fmt::format("unit {}", unit)));
  }
  Result<void> taken = take_reply(request, std::span(*reply).subspan(1), into);
  stirred_ = clock_.now();
  const bool is_ours = taken || taken.error().code == ErrorCode::DeviceRefused;
  settle_debt(is_ours ? reply_bytes(request) : reply->size() + kCrcBytes);
  return taken;
}

}  // namespace gonio::drivers
