#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "drivers/links/camera_link.h"

namespace gonio::drivers {

/// What a camera is plugged into.
enum class CameraTransport : std::uint8_t { Gige, Usb3 };

struct AravisCameraConfig {
  /// IPv4, in digits. Empty: the camera is searched for by its serial number. For GigE that is one broadcast (a GVCP
  /// discovery of 8 bytes to 255.255.255.255 from every network interface of this machine) and a second of listening
  /// for the answers; for USB a look at the devices on the bus. A camera with another serial number is never opened.
  std::string address;
  /// How long a camera that another controller holds is tried again. A killed controller's hold ends with the camera's
  /// own heartbeat timeout, 3 s as Aravis sets it.
  Duration control_wait = std::chrono::seconds(8);
  std::string serial;  ///< of the camera that is searched for
  CameraTransport transport = CameraTransport::Gige;
};

/// A GigE Vision or USB3 Vision camera by Aravis. Features are tried by these names, the first that the camera has
/// counts: ExposureTime, ExposureTimeAbs [us]; Gain, GainAbs [dB], GainRaw (steps of the maker's: 0 dB is the lowest,
/// more is refused); DeviceTemperature, DeviceTemperatureAbs [deg C]. ExposureAuto and GainAuto are switched off at
/// opening, and AcquisitionFrameRateEnable or AcquisitionFrameRateEnabled: a frame rate bounds the exposure. Aravis
/// keeps threads of its own (heartbeat, stream); they end with `close`.
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
  Result<std::optional<double>> temperature_c() override;
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
