#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "drivers/detector.h"
#include "drivers/links/camera_format.h"

namespace gonio::drivers {

/// A frame as it came off the wire, whole or not.
struct CameraFrame {
  bool is_complete = false;
  std::string trouble;  ///< what is wrong with it, when it is not complete; packets that are missing, counted
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> pixels;  ///< [height][width], unpacked; empty when it is not complete
  std::uint64_t frame_id = 0;
  std::uint64_t camera_time_ns = 0;  ///< of the camera's own clock, its ticks turned into ns
};

/// A way to one camera by GenICam features, of the few kinds that a detector needs. Features keep what was written only
/// as far as the camera takes it: read back what matters.
///
/// Errors of all calls: Unreachable (no answer), ControlLost (another controller has it), DeviceRefused (the camera
/// said no), WrongState (not open, or not streaming). A call may block for the link's own timeout: 5 s when a GigE
/// camera is gone. Threads: owned by one.
class CameraLink {
 public:
  virtual ~CameraLink() = default;

  /// Finds the camera (how, is the link's own), takes control, and switches off what would change settings by itself. A
  /// camera that another controller still holds is tried again up to the link's own bound. Opening what is open closes
  /// it first.
  [[nodiscard]] virtual Result<DetectorIdentity> open() = 0;
  virtual void close() = 0;
  [[nodiscard]] virtual bool is_open() const = 0;
  /// True from when another controller took the camera or it fell silent, until the next `open`.
  [[nodiscard]] virtual bool has_lost_control() const = 0;

  /// Only while not streaming.
  [[nodiscard]] virtual Result<void> set_format(const CameraFormat& format) = 0;
  [[nodiscard]] virtual Result<CameraFormat> format() = 0;
  [[nodiscard]] virtual Result<void> set_exposure(const ExposureSettings& settings) = 0;
  [[nodiscard]] virtual Result<ExposureSettings> exposure() = 0;
  /// Nothing: the camera has no such sensor.
  [[nodiscard]] virtual Result<std::optional<double>> temperature_c() = 0;

  /// Sets the software trigger, makes buffers for the format, starts. Frame ids begin anew.
  [[nodiscard]] virtual Result<void> start() = 0;
  virtual void stop() = 0;
  [[nodiscard]] virtual bool is_streaming() const = 0;
  [[nodiscard]] virtual Result<void> trigger() = 0;
  /// The oldest frame that has come, after `wait` at most; zero only looks.
  [[nodiscard]] virtual Result<std::optional<CameraFrame>> pop(Duration wait) = 0;
};

}  // namespace gonio::drivers
