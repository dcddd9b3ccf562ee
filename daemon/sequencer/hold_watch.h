#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "base/clock.h"
#include "daemon/config/instrument.h"
#include "daemon/store/records.h"
#include "drivers/stage.h"

namespace gonio::daemon {

/// Watches the causes of holds: the door, the lamp by its monitor, the stage, the store's disk. Pure: what was seen,
/// and when, are arguments.
class HoldWatch {
 public:
  HoldWatch(const HoldRules& rules, const LampBand& lamp, bool has_own_monitor)
      : rules_(rules), lamp_(lamp), has_own_monitor_(has_own_monitor) {}

  void see_stage(const drivers::StageState& state, Instant now);
  void see_stage_failing(const Error& error);
  /// A value of whatever monitors the lamp, in its light.
  void see_lamp(double monitor, Instant now);
  void see_disk(std::int64_t free_bytes, Instant now);

  /// Why the cause of a hold stands, as last seen; nothing: it has gone, or cannot be seen from here.
  [[nodiscard]] std::optional<std::string> standing(HoldName hold) const;
  /// Whether the instrument's file lets a hold of `owner` end by itself now: its cause has not been seen for as long as
  /// the file asks.
  [[nodiscard]] bool ends_by_itself(const Hold& hold, Instant now) const;
  /// Whether a device's hold may end because the stage lost power, has come back since and answers without a fault: for
  /// plans that ask to resume after a restart. What came of its place is verified by preparing.
  [[nodiscard]] bool ends_after_boot(const Hold& hold, Instant now) const;
  /// When a hold that nothing more is seen of may end; nothing: not by itself, or its cause stands.
  [[nodiscard]] std::optional<Instant> ends_at(const Hold& hold) const;
  [[nodiscard]] std::optional<std::string> lamp_is_out() const { return standing(HoldName::Lamp); }

 private:
  struct Cause {
    std::optional<std::string> why;       ///< as last seen
    std::optional<Instant> gone_since{};  ///< seen to be gone, without a break
  };
  [[nodiscard]] Cause& of(HoldName hold) { return causes_[static_cast<std::size_t>(hold)]; }
  [[nodiscard]] const Cause& of(HoldName hold) const { return causes_[static_cast<std::size_t>(hold)]; }
  void note(HoldName hold, std::optional<std::string> why, Instant now);
  [[nodiscard]] std::optional<Duration> rule(HoldName hold) const;

  HoldRules rules_;
  LampBand lamp_;
  bool has_own_monitor_;  ///< a radiometer: the stage's monitor says nothing
  std::array<Cause, 7> causes_;
  std::optional<std::uint32_t> boot_counter_;  ///< as last seen
  std::optional<Instant> booted_;              ///< seen to have booted, last
};

}  // namespace gonio::daemon
