#pragma once

#include <optional>
#include <string>

#include "base/clock.h"
#include "drivers/detector.h"
#include "drivers/links/camera_link.h"

namespace gonio::drivers {

/// A GenICam camera as instrument.toml has it.
struct GenicamCameraConfig {
  std::string serial;  ///< the camera must be this one
  CameraFormat format;
  ExposureSettings settings;                        ///< until the first `apply`
  Duration frame_margin = std::chrono::seconds(1);  ///< beyond the exposure: readout, transfer, resent packets
};

/// A GenICam camera with a software trigger, over a camera link.
///
/// After every opening all settings are written and read back: a camera that came back kept none or another's. One
/// trigger, one frame: frames that are there before a trigger are dropped, and the frame must bear the id after the
/// last one's. After a frame that was late or not the one asked for, the stream is made anew, so that ids count from
/// the start again.
class GenicamCamera final : public Detector {
 public:
  /// `link` and `clock` must outlive the camera.
  GenicamCamera(CameraLink& link, GenicamCameraConfig config, const Clock& clock);

  Result<DetectorIdentity> ensure_open() override;
  Result<void> apply(const ExposureSettings& settings) override;
  Result<void> trigger() override;
  Result<std::optional<Frame>> collect(Duration wait) override;

 private:
  [[nodiscard]] Result<void> open();
  [[nodiscard]] Result<void> write_format();
  [[nodiscard]] Result<void> write_exposure(const ExposureSettings& settings);
  [[nodiscard]] Result<void> restart_stream();
  [[nodiscard]] Result<void> drain();
  [[nodiscard]] Result<Frame> accepted(CameraFrame frame, Instant now);
  [[nodiscard]] Result<void> refresh_temperature(Instant now);
  [[nodiscard]] Error error(ErrorCode code, std::string tried, std::string seen, std::string limit = {}) const;

  CameraLink& link_;
  GenicamCameraConfig config_;
  const Clock& clock_;
  DetectorIdentity identity_;
  bool is_ready_ = false;  ///< open, ours, configured, streaming
  bool needs_new_stream_ = false;
  ExposureSettings wanted_;
  ExposureSettings taken_;                ///< as read back
  std::optional<std::uint64_t> last_id_;  ///< nothing: the stream is new
  std::uint64_t last_time_ns_ = 0;        ///< of the last frame, as the camera says; 0: none yet
  std::optional<Instant> triggered_;      ///< set while a frame is awaited
  std::optional<double> temperature_c_;
  std::optional<Instant> temperature_at_;
};

}  // namespace gonio::drivers
