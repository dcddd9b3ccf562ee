#pragma once

#include <optional>

#include "drivers/links/camera_link.h"
#include "sim/wires/live_instrument.h"

namespace gonio::test {

/// The simulated camera without a wire. `pop` never waits, whatever it is asked to: on a ManualClock nothing would
/// come.
class InProcessCameraLink final : public drivers::CameraLink {
 public:
  explicit InProcessCameraLink(sim::LiveInstrument& instrument) : instrument_(instrument) {}

  Result<drivers::DetectorIdentity> open() override;
  void close() override { is_open_ = is_streaming_ = false; }
  bool is_open() const override { return is_open_; }
  bool has_lost_control() const override { return broken_.has_value(); }
  Result<void> set_format(const drivers::CameraFormat& format) override;
  Result<drivers::CameraFormat> format() override;
  Result<void> set_exposure(const drivers::ExposureSettings& settings) override;
  Result<drivers::ExposureSettings> exposure() override;
  Result<std::optional<double>> temperature_c() override;
  Result<void> start() override;
  void stop() override { is_streaming_ = false; }
  bool is_streaming() const override { return is_streaming_; }
  Result<void> trigger() override;
  Result<std::optional<drivers::CameraFrame>> pop(Duration wait) override;

  /// From now on control is lost and every call fails so, until it is cleared and the link opened anew.
  void set_broken(std::optional<Error> error) { broken_ = std::move(error); }

 private:
  [[nodiscard]] Result<void> ready() const;

  sim::LiveInstrument& instrument_;
  std::optional<Error> broken_;
  drivers::CameraFormat format_;
  bool is_open_ = false;
  bool is_streaming_ = false;
};

}  // namespace gonio::test
