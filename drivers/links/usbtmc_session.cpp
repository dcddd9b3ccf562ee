#include "drivers/links/usbtmc_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "protocol/usbtmc/scpi.h"

namespace gonio::drivers {
namespace {

using usbtmc::Status;

constexpr int kMostChecks = 200;        // of an abort or a clear that stays pending
constexpr int kMostNotifications = 16;  // that were not asked for, before the one that was
constexpr std::size_t kPacketBytes = 512;
constexpr std::uint8_t kStatusNotification = 0x80;  // USB488 1.0, table 5: bit 7 and the tag of READ_STATUS_BYTE

std::string asked_words(std::string_view message) {
  return fmt::format("ask \"{}\"", message);
}

bool is_gone(ErrorCode code) {
  return code == ErrorCode::Unreachable || code == ErrorCode::ControlLost || code == ErrorCode::WrongState;
}

}  // namespace

UsbtmcSession::UsbtmcSession(UsbtmcLink& link, UsbtmcSessionConfig config, const Clock& clock)
    : link_(link), config_(std::move(config)), clock_(clock) {}

Result<DetectorIdentity> UsbtmcSession::open() {
  asked_.reset();
  Result<DetectorIdentity> who = link_.open();
  if (!who) return failure(std::move(who).error());
  if (Result<void> cleared = clear(); !cleared) {
    close();
    Error error = std::move(cleared).error();
    error.device = config_.role;
    error.tried = "empty the device after opening it: " + error.tried;
    return failure(std::move(error));
  }
  return who;
}

void UsbtmcSession::close() {
  asked_.reset();
  link_.close();
}

// Says what was wanted in front of what the transfer tried, and brings the device back into step.
tl::unexpected<Error> UsbtmcSession::failed(Error error, const std::string& tried) {
  error.device = config_.role;
  error.tried = error.tried.empty() ? tried : tried + ": " + error.tried;
  if (is_gone(error.code)) {
    close();
  } else {
    recover();
  }
  return failure(std::move(error));
}

Result<void> UsbtmcSession::send(std::string_view message) {
  if (asked_) recover();  // its reply is no longer wanted
  std::vector<std::uint8_t> line(message.begin(), message.end());
  line.push_back('\n');
  const auto bytes = usbtmc::dev_dep_msg_out(tags_.next(), line, true);
  if (auto sent = link_.bulk_out(bytes, config_.transfer_timeout); !sent) {
    return failed(std::move(sent).error(), fmt::format("send \"{}\"", message));
  }
  return {};
}

Result<void> UsbtmcSession::ask(std::string_view message, Duration within) {
  GONIO_TRY(send(message));
  asked_ = Asked{.message = std::string(message), .deadline = clock_.now() + within, .within = within, .text = {}};
  return request_reply();
}

Result<void> UsbtmcSession::request_reply() {
  asked_->tag = tags_.next();
  const auto bytes = usbtmc::request_dev_dep_msg_in(asked_->tag, config_.most_reply_bytes);
  if (auto sent = link_.bulk_out(bytes, config_.transfer_timeout); !sent) {
    return failed(std::move(sent).error(), asked_words(asked_->message));
  }
  return {};
}

Result<std::optional<std::string>> UsbtmcSession::poll(Duration wait) {
  if (!asked_) {
    return failure({.code = ErrorCode::WrongState,
                    .device = config_.role,
                    .tried = "fetch a reply",
                    .seen = "nothing was asked",
                    .limit = {}});
  }
  const std::size_t room = usbtmc::kHeaderBytes + config_.most_reply_bytes + usbtmc::kMostFillBytes;
  const std::size_t most = (room + kPacketBytes - 1) / kPacketBytes * kPacketBytes;
  while (true) {
    const Duration patience =
        std::clamp(asked_->deadline - clock_.now(), Duration::zero(), std::max(wait, Duration::zero()));
    auto bytes = link_.bulk_in(most, patience);
    if (!bytes) {
      Error error = std::move(bytes).error();
      const bool is_late = clock_.now() >= asked_->deadline;
      if (error.code == ErrorCode::TimedOut && !is_late) return std::optional<std::string>();
      if (error.code == ErrorCode::TimedOut) {
        error.tried.clear();
        error.seen = "no reply";
        error.limit = fmt::format("{:.0f} ms", in_seconds(asked_->within) * 1e3);
      }
      return failed(std::move(error), asked_words(asked_->message));
    }
    auto text = take(*std::move(bytes));
    if (!text || *text) return text;
  }
}

// One transfer of the reply: nothing when there are more to come, which are then asked for.
Result<std::optional<std::string>> UsbtmcSession::take(std::vector<std::uint8_t> bytes) {
  const std::string tried = asked_words(asked_->message);
  auto part = usbtmc::parse_dev_dep_msg_in(bytes, asked_->tag, config_.most_reply_bytes);
  if (!part) return failed(std::move(part).error(), tried);
  asked_->text.append(part->payload.begin(), part->payload.end());
  if (part->is_end) {
    const Asked done = *std::exchange(asked_, std::nullopt);
    return std::optional<std::string>(scpi::trimmed(done.text));
  }
  if (asked_->text.size() >= config_.most_reply_bytes) {
    return failed({.code = ErrorCode::BadReply,
                   .device = {},
                   .tried = {},
                   .seen = fmt::format("{} bytes and no end", asked_->text.size()),
                   .limit = fmt::format("{} bytes", config_.most_reply_bytes)},
                  tried);
  }
  GONIO_TRY(request_reply());
  return std::optional<std::string>();
}

Result<std::string> UsbtmcSession::query(std::string_view message, Duration within) {
  GONIO_TRY(ask(message, within));
  auto reply = poll(within);
  if (!reply) return failure(std::move(reply).error());
  if (*reply) return **std::move(reply);
  return failed({.code = ErrorCode::TimedOut,
                 .device = {},
                 .tried = {},
                 .seen = "no reply",
                 .limit = fmt::format("{:.0f} ms", in_seconds(within) * 1e3)},
                asked_words(message));
}

Result<std::uint8_t> UsbtmcSession::status_byte() {
  const std::string tried = "read the status byte";
  const UsbtmcInterface interface = link_.interface();
  const std::uint8_t tag = status_tags_.next();
  auto answer = link_.control_in(usbtmc::read_status_byte(interface.number, tag), config_.transfer_timeout);
  if (!answer) return failed(std::move(answer).error(), tried);
  const bool is_whole = answer->size() == 3 && static_cast<Status>(answer->front()) == Status::Success;
  if (!is_whole || (*answer)[1] != tag) {
    return failed({.code = is_whole ? ErrorCode::StaleData : ErrorCode::BadReply,
                   .device = {},
                   .tried = {},
                   .seen = answer->empty() ? "no bytes"
                                           : fmt::format("status 0x{:02X}, {} bytes", answer->front(), answer->size()),
                   .limit = fmt::format("status 0x01, tag {}, status byte", tag)},
                  tried);
  }
  if (interface.interrupt_in == 0) return (*answer)[2];
  auto byte = notified_status(tag);
  if (!byte) return failed(std::move(byte).error(), tried);
  return byte;
}

// Where there is an Interrupt-IN endpoint the byte comes there, behind service requests and answers to older queries.
Result<std::uint8_t> UsbtmcSession::notified_status(std::uint8_t tag) {
  for (int k = 0; k < kMostNotifications; ++k) {
    auto bytes = link_.interrupt_in(config_.transfer_timeout);
    if (!bytes) return failure(std::move(bytes).error());
    if (bytes->size() == 2 && bytes->front() == (kStatusNotification | tag)) return bytes->back();
  }
  return failure({.code = ErrorCode::StaleData,
                  .device = {},
                  .tried = {},
                  .seen = fmt::format("{} other notifications", kMostNotifications),
                  .limit = fmt::format("the one of tag {}", tag)});
}

void UsbtmcSession::recover() {
  if (!link_.is_open()) return;
  if (const auto asked = std::exchange(asked_, std::nullopt)) abort_bulk_in(asked->tag);
  if (!clear()) close();
}

// USBTMC 1.0, 4.2.1.4 and 4.2.1.5. What goes wrong here the clear that follows puts right.
void UsbtmcSession::abort_bulk_in(std::uint8_t tag) {
  const std::uint8_t endpoint = link_.interface().bulk_in;
  const auto answer = link_.control_in(usbtmc::initiate_abort_bulk_in(endpoint, tag), config_.transfer_timeout);
  if (!answer || answer->empty() || static_cast<Status>(answer->front()) != Status::Success) return;
  drain();
  for (int k = 0; k < kMostChecks; ++k) {
    const auto check = link_.control_in(usbtmc::check_abort_bulk_in_status(endpoint), config_.transfer_timeout);
    if (!check) return;
    const auto progress = usbtmc::parse_progress(*check);
    if (!progress || progress->status != Status::Pending) return;
    if (progress->has_data) drain();
  }
}

// USBTMC 1.0, 4.2.1.6 and 4.2.1.7.
Result<void> UsbtmcSession::clear() {
  const UsbtmcInterface interface = link_.interface();
  auto answer = link_.control_in(usbtmc::initiate_clear(interface.number), config_.transfer_timeout);
  if (!answer) return failure(std::move(answer).error());
  const auto status = usbtmc::parse_status(*answer);
  if (!status) return failure(status.error());
  if (*status != Status::Success) {
    return failure({.code = ErrorCode::DeviceRefused,
                    .device = {},
                    .tried = "clear",
                    .seen = fmt::format("status 0x{:02X}", static_cast<unsigned>(*status)),
                    .limit = "0x01"});
  }
  GONIO_TRY(wait_until_clear());
  GONIO_TRY(link_.clear_halt(interface.bulk_out));
  return link_.clear_halt(interface.bulk_in);
}

Result<void> UsbtmcSession::wait_until_clear() {
  const std::uint8_t number = link_.interface().number;
  for (int k = 0; k < kMostChecks; ++k) {
    const auto check = link_.control_in(usbtmc::check_clear_status(number), config_.transfer_timeout);
    if (!check) return failure(check.error());
    const auto progress = usbtmc::parse_progress(*check);
    if (!progress) return failure(progress.error());
    if (progress->status == Status::Success) return {};
    if (progress->status != Status::Pending) break;
    if (progress->has_data) drain();
  }
  return failure({.code = ErrorCode::TimedOut,
                  .device = {},
                  .tried = "clear",
                  .seen = "it does not get done",
                  .limit = fmt::format("{} checks", kMostChecks)});
}

// Reads on until a short packet or an end. What comes is nobody's.
void UsbtmcSession::drain() {
  const auto bytes =
      link_.bulk_in(usbtmc::kHeaderBytes + config_.most_reply_bytes + kPacketBytes, config_.transfer_timeout);
  if (!bytes && bytes.error().code == ErrorCode::DeviceRefused) {
    static_cast<void>(link_.clear_halt(link_.interface().bulk_in));
  }
}

}  // namespace gonio::drivers
