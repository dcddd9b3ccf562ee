#pragma once

#include "drivers/links/camera_link.h"
#include "drivers/links/tape/tape_channel.h"

namespace gonio::drivers {

/// A camera link whose calls are recorded, frames with all their pixels. It changes nothing of what passes.
class TapedCameraLink final : public CameraLink {
 public:
  /// `link` must outlive it.
  TapedCameraLink(CameraLink& link, TapeChannel channel) : link_(link), channel_(channel) {}

  Result<DetectorIdentity> open() override;
  void close() override;
  bool is_open() const override;
  bool has_lost_control() const override;
  Result<void> set_format(const CameraFormat& format) override;
  Result<CameraFormat> format() override;
  Result<void> set_exposure(const ExposureSettings& settings) override;
  Result<ExposureSettings> exposure() override;
  Result<std::optional<double>> temperature_c() override;
  Result<void> start() override;
  void stop() override;
  bool is_streaming() const override;
  Result<void> trigger() override;
  Result<std::optional<CameraFrame>> pop(Duration wait) override;

 private:
  CameraLink& link_;
  TapeChannel channel_;
};

}  // namespace gonio::drivers
