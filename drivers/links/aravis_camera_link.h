#pragma once

#include <memory>
#include <string>

#include "drivers/links/camera_link.h"

namespace gonio::drivers {

struct AravisCameraConfig {
  std::string address;  ///< IPv4, in digits
  /// How long a camera that another controller holds is tried again. A killed controller's hold ends with the camera's
  /// own heartbeat timeout, 3 s as Aravis sets it.
  Duration control_wait = std::chrono::seconds(8);
};

/// A GigE Vision camera by Aravis. Aravis keeps threads of its own (heartbeat, stream); they end with `close`.
class AravisCameraLink final : public CameraLink {
 public:
  explicit AravisCameraLink(AravisCameraConfig config);
  ~AravisCameraLink() override;

  Result<DetectorIdentity> open() override;
  void close() override;
  bool is_open() const override;
  bool has_lost_control() const override;
  Result<void> set_format(const CameraFormat& format) override;
  Result<CameraFormat> format() override;
  Result<void> set_exposure(const ExposureSettings& settings) override;
  Result<ExposureSettings> exposure() override;
  Result<double> temperature_c() override;
  Result<void> start() override;
  void stop() override;
  bool is_streaming() const override;
  Result<void> trigger() override;
  Result<std::optional<CameraFrame>> pop(Duration wait) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gonio::drivers
