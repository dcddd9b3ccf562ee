#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/wires/gvcp.h"

namespace gonio::sim {

/// Where things lie in the camera's memory: bootstrap registers of GigE Vision 2.0 (section 28), then the features.
namespace address {
inline constexpr std::uint32_t kHeartbeatTimeoutMs = 0x0938;
inline constexpr std::uint32_t kControl = 0x0A00;  ///< control channel privilege
inline constexpr std::uint32_t kStreamPort = 0x0D00;
inline constexpr std::uint32_t kPacketSize = 0x0D04;
inline constexpr std::uint32_t kStreamAddress = 0x0D18;
inline constexpr std::uint32_t kAcquisition = 0x4000;
inline constexpr std::uint32_t kWidth = 0x4004;
inline constexpr std::uint32_t kHeight = 0x4008;
inline constexpr std::uint32_t kOffsetX = 0x400C;
inline constexpr std::uint32_t kOffsetY = 0x4010;
inline constexpr std::uint32_t kPixelFormat = 0x4014;
inline constexpr std::uint32_t kAcquisitionMode = 0x4018;
inline constexpr std::uint32_t kTriggerMode = 0x401C;
inline constexpr std::uint32_t kTriggerSource = 0x4020;
inline constexpr std::uint32_t kTriggerSelector = 0x4024;
inline constexpr std::uint32_t kTriggerSoftware = 0x4028;
inline constexpr std::uint32_t kPayloadSize = 0x402C;   ///< bytes of an image; read only
inline constexpr std::uint32_t kExposureUs = 0x4030;    ///< 8 bytes, double
inline constexpr std::uint32_t kGainDb = 0x4038;        ///< 8 bytes, double
inline constexpr std::uint32_t kTemperatureC = 0x4040;  ///< 8 bytes, double
inline constexpr std::uint32_t kDescription = 0x10000;  ///< the GenICam XML
}  // namespace address

inline constexpr std::uint32_t kTicksPerSecond = 125000000;  ///< of the camera's clock, as many a real one's

/// Who the camera says it is, and what it can do.
struct CameraIdentity {
  std::string address;  ///< IPv4
  std::string serial;   ///< at most 15 characters
  int width_px = 0;     ///< of the sensor
  int height_px = 0;
  int bits = 12;                        ///< of a pixel: it sends the formats that have them
  std::string pixel_format = "Mono12";  ///< at power-up
  double shortest_exposure_us = 0.0;
  double longest_exposure_us = 0.0;
  double most_gain_db = 0.0;
  std::optional<double> temperature_c;  ///< nothing: it has no sensor
  std::uint32_t heartbeat_timeout_ms = 3000;
};

/// The GenICam description (GenApi schema 1.1) of the features at the addresses above.
[[nodiscard]] std::string genicam_description(const CameraIdentity& identity);

/// The camera's memory. What a write *does* is its server's; here it is only checked. Threads: owned by one.
class CameraRegisters {
 public:
  explicit CameraRegisters(const CameraIdentity& identity);

  [[nodiscard]] std::uint32_t word(std::uint32_t at) const;
  void set_word(std::uint32_t at, std::uint32_t value);
  [[nodiscard]] double number(std::uint32_t at) const;
  void set_number(std::uint32_t at, double value);

  /// Beyond the memory and the description: InvalidAddress.
  [[nodiscard]] GvcpStatus read(std::uint32_t at, std::size_t count, std::vector<std::uint8_t>& out) const;
  /// Whether this word takes this value: InvalidAddress, BadAlignment, WriteProtect, InvalidParameter.
  [[nodiscard]] GvcpStatus check_write(std::uint32_t at, std::uint32_t value) const;
  /// The image's size follows from region and format: to be called after one of them was written.
  void refresh_payload_size();
  /// The first 248 bytes, as discovery answers them.
  [[nodiscard]] std::span<const std::uint8_t> discovery() const;

 private:
  void set_text(std::uint32_t at, std::size_t room, const std::string& text);
  void describe_device(const CameraIdentity& identity);

  [[nodiscard]] GvcpStatus check_image(std::uint32_t at, std::uint32_t value) const;

  std::uint32_t sensor_width_;
  std::uint32_t sensor_height_;
  int bits_;
  std::vector<std::uint8_t> memory_;
  std::string description_;
};

}  // namespace gonio::sim
