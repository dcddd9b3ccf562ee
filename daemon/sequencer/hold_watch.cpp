#include "daemon/sequencer/hold_watch.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

namespace gonio::daemon {

void HoldWatch::note(HoldName hold, std::optional<std::string> why, Instant now) {
  Cause& cause = of(hold);
  if (why) {
    cause.gone_since.reset();
  } else if (!cause.gone_since) {
    cause.gone_since = now;
  }
  cause.why = std::move(why);
}

void HoldWatch::see_stage(const drivers::StageState& state, Instant now) {
  const auto when = [](bool stands, std::string why) { return stands ? std::optional(std::move(why)) : std::nullopt; };
  if (boot_counter_ && *boot_counter_ != state.boot_counter) booted_ = now;
  boot_counter_ = state.boot_counter;
  note(HoldName::Door, when(state.interlock_open, "the interlock is open"), now);
  note(HoldName::Device, when(state.fault != 0, fmt::format("the stage's fault word is {}", state.fault)), now);
  const bool is_in_light = lamp_.before_shutter || state.source_shutter == stage::ShutterState::Open;
  if (!has_own_monitor_ && is_in_light) return see_lamp(state.monitor, now);
  of(HoldName::Lamp) = {};  // what was seen of it once says nothing any more
}

void HoldWatch::see_stage_failing(const Error& error) {
  // What cannot be seen is not seen to be gone; it is not seen to stand either: the door keeps its last word.
  for (const HoldName hold : {HoldName::Door, HoldName::Lamp, HoldName::Device}) of(hold).gone_since.reset();
  of(HoldName::Device).why = describe(error);
}

void HoldWatch::see_lamp(double monitor, Instant now) {
  std::optional<std::string> why;
  if (monitor < lamp_.low || monitor > lamp_.high) {
    why = fmt::format("lamp monitor {:.4g}, limits {:.4g} to {:.4g}", monitor, lamp_.low, lamp_.high);
  }
  note(HoldName::Lamp, std::move(why), now);
}

void HoldWatch::see_disk(std::int64_t free_bytes, Instant now) {
  constexpr double kMebibyte = 1024.0 * 1024.0;
  // Between the two limits what was true before stays true.
  const bool was_full = of(HoldName::Disk).why.has_value();
  const std::int64_t limit = was_full ? rules_.disk_again_bytes : rules_.disk_least_bytes;
  std::optional<std::string> why;
  if (free_bytes < limit) {
    why = fmt::format("{:.1f} MiB free on the store's disk, limit {:.1f} MiB",
                      static_cast<double>(free_bytes) / kMebibyte, static_cast<double>(limit) / kMebibyte);
  }
  note(HoldName::Disk, std::move(why), now);
}

std::optional<std::string> HoldWatch::standing(HoldName hold) const {
  // Of a device that failed, a look at the stage says too little: trying is the test.
  if (hold == HoldName::Device) return std::nullopt;
  return of(hold).why;
}

std::optional<Duration> HoldWatch::rule(HoldName hold) const {
  switch (hold) {
    case HoldName::Lamp:
      return rules_.lamp;
    case HoldName::Door:
      return rules_.door;
    case HoldName::Device:
      return rules_.device;
    case HoldName::Disk:
      return rules_.disk;
    default:
      return std::nullopt;  // the operator's, a restart's: a person's word
  }
}

std::optional<Instant> HoldWatch::ends_at(const Hold& hold) const {
  const auto wait = rule(hold.name);
  const Cause& cause = of(hold.name);
  if (!wait || !cause.gone_since) return std::nullopt;
  return std::max(*cause.gone_since, hold.since) + *wait;
}

bool HoldWatch::ends_by_itself(const Hold& hold, Instant now) const {
  const auto at = ends_at(hold);
  return at && now >= *at;
}

bool HoldWatch::ends_after_boot(const Hold& hold, Instant now) const {
  constexpr Duration kQuiet = std::chrono::seconds(1);
  constexpr Duration kBefore = std::chrono::seconds(30);  // what fails so soon after a boot fails because of it
  const Cause& device = of(HoldName::Device);
  if (hold.name != HoldName::Device || !booted_ || !device.gone_since) return false;
  return *booted_ >= hold.since - kBefore && now >= std::max({*device.gone_since, hold.since, *booted_}) + kQuiet;
}

}  // namespace gonio::daemon
