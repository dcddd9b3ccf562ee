#include "base/clock.h"

#include <ctime>

#include <cstdio>
#include <limits>

namespace gonio {
namespace {

Duration read_clock(clockid_t id) {
  timespec t{};
  clock_gettime(id, &t);
  return std::chrono::seconds(t.tv_sec) + Duration(t.tv_nsec);
}

constexpr std::chrono::sys_days kManualDay{std::chrono::year{2026} / 1 / 1};
constexpr Duration kManualStart = std::chrono::seconds(1000);

}  // namespace

Duration seconds(double value) {
  constexpr double kMost = 9.2e9;  // just below 2^63 ns
  if (value >= kMost) return Duration::max();
  if (value <= -kMost) return Duration::min();
  return Duration(static_cast<std::int64_t>(value * 1e9));
}

Instant SystemClock::now() const {
  return Instant(read_clock(CLOCK_BOOTTIME));
}
UtcTime SystemClock::utc_now() const {
  return UtcTime(read_clock(CLOCK_REALTIME));
}

ManualClock::ManualClock() : boot_ns_(kManualStart.count()) {}
Instant ManualClock::now() const {
  return Instant(Duration(boot_ns_.load()));
}
UtcTime ManualClock::utc_now() const {
  return UtcTime(kManualDay) + (now().time_since_epoch() - kManualStart);
}

void ManualClock::advance_to(Instant t) {
  const std::int64_t wanted = t.time_since_epoch().count();
  std::int64_t seen = boot_ns_.load();
  while (seen < wanted && !boot_ns_.compare_exchange_weak(seen, wanted)) {
  }
}

std::string iso8601(UtcTime t) {
  const auto day = std::chrono::floor<std::chrono::days>(t);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss time(std::chrono::floor<std::chrono::milliseconds>(t - day));
  char text[40];
  std::snprintf(text, sizeof text, "%04d-%02u-%02uT%02d:%02d:%02d.%03dZ", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(time.hours().count()), static_cast<int>(time.minutes().count()),
                static_cast<int>(time.seconds().count()), static_cast<int>(time.subseconds().count()));
  return text;
}

}  // namespace gonio
