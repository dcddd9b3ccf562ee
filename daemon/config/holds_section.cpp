#include "daemon/config/holds_section.h"

#include <cmath>

namespace gonio::daemon {
namespace {

constexpr double kADay = 86'400.0;
constexpr double kMebibyte = 1024.0 * 1024.0;
constexpr double kLeastMebibytes = 100.0;
constexpr double kAgainOverLeast = 1.25;

std::optional<Duration> time_without_cause(TomlReader& table, std::string_view key) {
  const auto given = table.optional_number(key, {.least = 0.0, .most = kADay, .unit = "s"});
  if (!given) return std::nullopt;
  return seconds(*given);
}

std::int64_t bytes_of(double mebibytes) {
  return std::llround(mebibytes * kMebibyte);
}

}  // namespace

HoldRules read_holds(TomlReader& root) {
  HoldRules rules;
  auto table = root.optional_table("holds");
  if (!table) return rules;
  rules.lamp = time_without_cause(*table, "lamp_s");
  rules.door = time_without_cause(*table, "door_s");
  rules.device = time_without_cause(*table, "device_s");
  rules.disk = time_without_cause(*table, "disk_s");
  const double least = table->number_or("disk_least_mib", kLeastMebibytes, {.least = 1.0, .unit = "MiB"});
  rules.disk_least_bytes = bytes_of(least);
  rules.disk_again_bytes =
      bytes_of(table->number_or("disk_again_mib", kAgainOverLeast * least, {.least = least, .unit = "MiB"}));
  return rules;
}

std::optional<LampWarmUp> read_warm_up(TomlReader& lamp_table) {
  auto table = lamp_table.optional_table("warm_up");
  if (!table) return std::nullopt;
  constexpr double kPercentPerMinute = 0.01 / 60.0;
  const double slope = table->number("slope_percent_per_min", {.least = 1e-6, .most = 100.0, .unit = "%/min"});
  const double over_s = table->number("over_s", {.least = 1.0, .most = kADay, .unit = "s"});
  return LampWarmUp{.slope_per_s = slope * kPercentPerMinute,
                    .over = seconds(over_s),
                    .at_most = seconds(table->number("at_most_s", {.least = over_s, .most = kADay, .unit = "s"}))};
}

}  // namespace gonio::daemon
