#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>

namespace gonio {

using Duration = std::chrono::nanoseconds;

/// Time since the machine's boot, suspended time included (CLOCK_BOOTTIME). Never steps: all intervals use it.
struct BootTime {
  using duration = Duration;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<BootTime>;
  static constexpr bool is_steady = true;
};
using Instant = BootTime::time_point;
using UtcTime = std::chrono::sys_time<Duration>;

[[nodiscard]] constexpr double in_seconds(Duration d) {
  return std::chrono::duration<double>(d).count();
}
/// Saturates instead of overflowing; `value` must not be NaN.
[[nodiscard]] Duration seconds(double value);

/// Where time comes from. Threads: any.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual Instant now() const = 0;
  [[nodiscard]] virtual UtcTime utc_now() const = 0;
};

class SystemClock final : public Clock {
 public:
  [[nodiscard]] Instant now() const override;
  [[nodiscard]] UtcTime utc_now() const override;
};

/// A clock that stands until it is told. Threads: any.
class ManualClock final : public Clock {
 public:
  /// Starts at 1000 s after boot, 2026-01-01T00:00:00Z, so that neither reads as zero.
  ManualClock();
  [[nodiscard]] Instant now() const override;
  [[nodiscard]] UtcTime utc_now() const override;
  /// Moves forward; a time already passed leaves the clock as it is.
  void advance_to(Instant t);
  void advance(Duration d) { advance_to(now() + d); }

 private:
  std::atomic<std::int64_t> boot_ns_;
};

/// "2026-01-01T00:00:00.000Z", always UTC, milliseconds.
[[nodiscard]] std::string iso8601(UtcTime t);

}  // namespace gonio
