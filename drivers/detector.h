#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/result.h"

namespace gonio::drivers {

struct ExposureSettings {
  Duration exposure{};
  double gain_db = 0.0;
  friend bool operator==(const ExposureSettings&, const ExposureSettings&) = default;
};

struct DetectorIdentity {
  std::string vendor;
  std::string model;
  std::string serial;
};

/// One frame as read: nothing subtracted, nothing clipped. Pixels row by row, top left first: [height][width].
struct Frame {
  int width = 0;
  int height = 0;
  int significant_bits = 12;  ///< full scale is 2^bits - 1
  std::vector<std::uint16_t> pixels;
  std::uint64_t frame_id = 0;           ///< the camera's own, grows by one
  std::uint64_t camera_time_ns = 0;     ///< the camera's own clock
  ExposureSettings settings;            ///< read back from the camera
  std::optional<double> temperature_c;  ///< nothing: the camera has no sensor
  Instant arrived{};
};

/// An imaging detector with a software trigger. Threads: owned by one; calls may block for the link's own timeout.
class Detector {
 public:
  virtual ~Detector() = default;

  /// Opens if it is not open: takes control, writes all settings of the configuration and reads them back.
  /// Errors: Unreachable, ControlLost (another controller has it: waited out up to a bound), WrongDevice,
  /// SettingNotTaken.
  [[nodiscard]] virtual Result<DetectorIdentity> ensure_open() = 0;
  /// Errors: as ensure_open; SettingNotTaken with what was asked and what was read back.
  [[nodiscard]] virtual Result<void> apply(const ExposureSettings& settings) = 0;
  /// Drops frames of earlier triggers, then starts one exposure. Errors: Unreachable, ControlLost, DeviceRefused.
  [[nodiscard]] virtual Result<void> trigger() = 0;
  /// The frame of the last trigger, or nothing yet after `wait` at most. Each trigger's frame is handed out once.
  /// Errors: IncompleteData, StaleData, ControlLost, Unreachable, TimedOut (the deadline computed at the trigger has
  /// passed).
  [[nodiscard]] virtual Result<std::optional<Frame>> collect(Duration wait) = 0;
};

}  // namespace gonio::drivers
