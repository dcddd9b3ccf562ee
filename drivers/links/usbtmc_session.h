#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/clock.h"
#include "base/result.h"
#include "drivers/links/usbtmc_link.h"
#include "protocol/usbtmc/message.h"

namespace gonio::drivers {

struct UsbtmcSessionConfig {
  std::string role = "radiometer";                             ///< named in errors
  Duration transfer_timeout = std::chrono::milliseconds(500);  ///< of what a device does at once
  std::uint32_t most_reply_bytes = 1024;
};

/// Messages of text over a UsbtmcLink: framing, tags, end of message, status byte, and the way back into step.
///
/// After any error the session has emptied the device (abort of the transfer under way, clear, halts cleared), or,
/// where that failed or the device was gone, closed it: no call ever finds a reply to an earlier one. Errors are the
/// link's and those of protocol/usbtmc/message.h; WrongState when it is not open. Threads: owned by one.
class UsbtmcSession {
 public:
  /// `link` and `clock` must outlive it.
  UsbtmcSession(UsbtmcLink& link, UsbtmcSessionConfig config, const Clock& clock);

  /// Opens the link and empties the device, which may be in the middle of what a killed program said.
  [[nodiscard]] Result<DetectorIdentity> open();
  void close();
  [[nodiscard]] bool is_open() const { return link_.is_open(); }

  /// Sends one message, a line without its end.
  [[nodiscard]] Result<void> send(std::string_view message);
  /// Sends a message and asks for the reply, which `poll` fetches; the device has until `within` from now.
  [[nodiscard]] Result<void> ask(std::string_view message, Duration within);
  /// The reply without its line end, or nothing yet after `wait` at most. Errors: TimedOut once `within` has passed;
  /// WrongState (nothing was asked).
  [[nodiscard]] Result<std::optional<std::string>> poll(Duration wait);
  /// Both in one step; waits for the reply, at most for `within`.
  [[nodiscard]] Result<std::string> query(std::string_view message, Duration within);
  [[nodiscard]] bool is_asking() const { return asked_.has_value(); }

  [[nodiscard]] Result<std::uint8_t> status_byte();

  /// Empties the device: for a reply that came in step but was not wanted.
  void recover();

 private:
  struct Asked {
    std::string message;
    std::uint8_t tag = 0;
    Instant deadline{};
    Duration within{};
    std::string text;  ///< the parts that have come
  };
  [[nodiscard]] tl::unexpected<Error> failed(Error error, const std::string& tried);
  [[nodiscard]] Result<void> request_reply();
  [[nodiscard]] Result<std::optional<std::string>> take(std::vector<std::uint8_t> bytes);
  [[nodiscard]] Result<std::uint8_t> notified_status(std::uint8_t tag);
  void abort_bulk_in(std::uint8_t tag);
  [[nodiscard]] Result<void> clear();
  [[nodiscard]] Result<void> wait_until_clear();
  void drain();

  UsbtmcLink& link_;
  UsbtmcSessionConfig config_;
  const Clock& clock_;
  usbtmc::TagSequence tags_;
  usbtmc::StatusTagSequence status_tags_;
  std::optional<Asked> asked_;
};

}  // namespace gonio::drivers
