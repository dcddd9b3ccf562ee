#pragma once

#include <optional>

#include "base/clock.h"
#include "base/result.h"
#include "base/units.h"
#include "drivers/detector.h"

namespace gonio::drivers {

struct RadiometerSettings {
  Wavelength wavelength;          ///< for which the meter turns current into power
  std::optional<double> range_w;  ///< full scale, one that the meter has; nothing: it chooses
  int averages = 1;               ///< of the meter itself, in each sample
  int samples = 10;               ///< in each reading; at least 2, since one has no scatter
  friend bool operator==(const RadiometerSettings&, const RadiometerSettings&) = default;
};

/// The mean of `samples` results of the meter, all in one range. Never made of an overload or of "not a number".
struct RadiometerReading {
  double mean_w = 0.0;
  double standard_error_w = 0.0;  ///< standard deviation / sqrt(samples), for samples that are independent
  int samples = 0;
  double range_w = 0.0;  ///< full scale
  Instant started{};     ///< the first sample that counts was asked for
  Instant ended{};       ///< the last one had come
};

/// A detector of radiant power without pixels, in the shape of `Detector`: for the light from the sample, or for the
/// lamp's. Threads: owned by one; calls may block for a few of the link's transfers.
///
/// Errors of all calls: Unreachable, TimedOut, ControlLost (another program has it), DeviceRefused (an entry of its
/// error queue, or a stall), BadReply, StaleData, IncompleteData. After any of them the next call starts on a device
/// that holds nothing of the last, opened anew where that is needed.
class Radiometer {
 public:
  virtual ~Radiometer() = default;

  /// Opens if it is not open, writes all settings and reads them back. Errors: WrongDevice, SettingNotTaken.
  [[nodiscard]] virtual Result<DetectorIdentity> ensure_open() = 0;
  /// Drops a reading under way. Errors: SettingNotTaken with what was asked and what was read back; InvalidInput.
  [[nodiscard]] virtual Result<void> apply(const RadiometerSettings& settings) = 0;

  /// Takes the light that is there as the new zero: shut it off first. `is_zeroed` tells when that is done, after
  /// `wait` at most. Errors: DeviceRefused (too much light), TimedOut, WrongState (none was started).
  [[nodiscard]] virtual Result<void> start_zero() = 0;
  [[nodiscard]] virtual Result<bool> is_zeroed(Duration wait) = 0;

  /// Drops a reading under way and starts one. Errors: WrongState (a zero is under way).
  [[nodiscard]] virtual Result<void> trigger() = 0;
  /// The reading of the last trigger, or nothing yet after `wait` at most. Each is handed out once. Samples from before
  /// a change of range has settled are thrown away.
  /// Errors: Saturated (a sample was an overload), OutOfTolerance (the meter kept changing its range), WrongState.
  [[nodiscard]] virtual Result<std::optional<RadiometerReading>> collect(Duration wait) = 0;
};

}  // namespace gonio::drivers
