#pragma once

#include <optional>
#include <string>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/config/power_meter.h"
#include "daemon/sequencer/messages.h"
#include "drivers/radiometer.h"

namespace gonio::daemon {

/// One radiometer's reading from settings to result, in looks that block for a few milliseconds each: what a radiometer
/// does in either of its places. Threads: one.
class PowerTask {
 public:
  /// `radiometer` must outlive it. `role`: "detector" or "monitor", in errors.
  PowerTask(drivers::Radiometer& radiometer, PowerMeterConfig meter, std::string role);

  /// Applies the settings if they changed, and starts a reading. Errors: as drivers::Radiometer.
  [[nodiscard]] Result<void> start(const drivers::RadiometerSettings& settings, Instant now);
  /// The finished reading, or nothing yet. Errors: as drivers::Radiometer; TimedOut (the deadline that followed from
  /// the settings at `start`).
  [[nodiscard]] Result<std::optional<PowerRecord>> look(Instant now);
  /// When to look first, and then again.
  [[nodiscard]] Instant next_look() const { return next_look_; }

 private:
  /// Whatever the meter was told may be gone.
  void forget() { applied_.reset(); }

  drivers::Radiometer& radiometer_;
  PowerMeterConfig meter_;
  std::string role_;
  std::optional<drivers::RadiometerSettings> applied_;
  Instant next_look_{};
  Instant deadline_{};
};

}  // namespace gonio::daemon
