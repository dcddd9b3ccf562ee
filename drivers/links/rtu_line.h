#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "base/clock.h"
#include "base/result.h"
#include "drivers/links/modbus_context.h"
#include "drivers/links/modbus_frames.h"
#include "drivers/links/serial_line.h"

namespace gonio::drivers {

struct RtuLineConfig {
  SerialLine line;
  std::uint8_t unit_id = 1;  ///< of the ways that name none
  Duration reply_timeout{};  ///< of one transaction; also how long a line must be quiet after an error
  /// The longest stop inside a reply: USB adapters hand bytes on in lumps up to 16 ms apart.
  Duration pause = std::chrono::milliseconds(20);
  /// Between frames; none: 3.5 characters, 1.75 ms at least (Modbus over Serial Line V1.02, 2.5.1.1).
  std::optional<Duration> silence = std::nullopt;
};

/// One exchange after the other on a serial line, each of which another thread can end.
///
/// A reply bears nothing but function and length, so a late one looks like the next one's. What is outstanding is
/// therefore counted, in bytes, and after any error but an exception reply the next exchange first waits until those
/// have come or the line has been quiet for a reply timeout. What comes later still only a token in the data can tell
/// (`protocol/stage`). Threads: owned by one, but for `owe` and `wake`.
class RtuLine {
 public:
  /// Asked whenever the line is woken, on the thread of the exchange: whether to give up.
  using GivesWay = std::function<bool()>;
  enum class Haste : std::uint8_t {
    None,
    Urgent,  ///< sends kUrgentWait after its call at the latest, whatever the line still holds
  };
  static constexpr Duration kUrgentWait = std::chrono::milliseconds(35);

  explicit RtuLine(RtuLineConfig config);
  ~RtuLine();
  RtuLine(const RtuLine&) = delete;
  RtuLine& operator=(const RtuLine&) = delete;

  /// Errors, with code, seen and limit only: as ModbusLink; Unreachable also when it gave way.
  [[nodiscard]] Result<void> exchange(std::uint8_t unit, const ModbusRequest& request, std::span<std::uint16_t> into,
                                      Haste haste, const GivesWay& gives_way);
  /// A reply of so many bytes may still come. Threads: any.
  void owe(std::size_t bytes) { owed_ += bytes; }
  /// Of a reply on the line, whole.
  [[nodiscard]] static std::size_t reply_bytes(const ModbusRequest& request);
  /// Makes the exchange in progress, or else the next one, ask `gives_way`. Threads: any.
  void wake();

  /// The longest that one exchange can take.
  [[nodiscard]] Duration longest_exchange() const;
  [[nodiscard]] std::uint8_t unit_id() const { return config_.unit_id; }

 private:
  [[nodiscard]] Result<void> open();
  void close();
  [[nodiscard]] Result<void> settle(Haste haste, const GivesWay& gives_way);
  void settle_debt(std::size_t bytes);
  [[nodiscard]] Result<void> send(std::uint8_t unit, const ModbusRequest& request);
  [[nodiscard]] Result<void> await_reply(std::size_t bytes, const GivesWay& gives_way);
  [[nodiscard]] Result<void> wait(Instant until, bool for_bytes, const GivesWay& gives_way);
  [[nodiscard]] Result<std::size_t> waiting_bytes();
  [[nodiscard]] Result<std::size_t> discard();
  [[nodiscard]] Duration time_of(std::size_t bytes) const;
  [[nodiscard]] Duration silence() const;
  [[nodiscard]] tl::unexpected<Error> broken(std::string seen);

  RtuLineConfig config_;
  SystemClock clock_;
  ModbusContext context_;
  int wake_ = -1;
  int tty_ = -1;                      ///< the context's
  std::atomic<std::size_t> owed_{0};  ///< bytes of replies that may still come
  Instant stirred_{};                 ///< when the line last carried something, as far as we know
};

}  // namespace gonio::drivers
