#include "sim/wires/camera_registers.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "sim/wires/big_endian.h"
#include "sim/wires/pixel_packing.h"

namespace gonio::sim {
namespace {

constexpr std::size_t kMemory = 0x5000;
constexpr std::size_t kDiscovery = 0xF8;
constexpr std::uint32_t kShortestHeartbeatMs = 500;  // GigE Vision 2.0, 28.34
constexpr std::uint32_t kSmallestPacket = 576;       // the IPv4 datagram that every host must take
constexpr std::uint32_t kLargestPacket = 9000;
constexpr std::uint32_t kUsualPacket = 1400;
constexpr std::uint32_t kSmallestSide = 4;  // pixels

/// A register that takes writes, and which values.
struct Writable {
  std::uint32_t at;
  std::uint32_t least = 0;
  std::uint32_t most = 0;
};

constexpr std::uint32_t kAny = 0xFFFFFFFF;
constexpr std::array kWritable{
    Writable{address::kHeartbeatTimeoutMs, kShortestHeartbeatMs, 60000},
    Writable{address::kControl, 0, kAny},
    Writable{address::kStreamPort, 0, kAny},
    Writable{address::kStreamAddress, 0, kAny},
    Writable{0x0D08, 0, kAny},  // packet delay
    Writable{address::kAcquisition, 0, 1},
    Writable{address::kAcquisitionMode, 0, 0},
    Writable{address::kTriggerMode, 0, 1},
    Writable{address::kTriggerSource, 0, 0},
    Writable{address::kTriggerSelector, 0, 0},
    Writable{address::kTriggerSoftware, 0, 1},
    Writable{address::kExposureUs, 0, kAny},
    Writable{address::kExposureUs + 4, 0, kAny},
    Writable{address::kGainDb, 0, kAny},
    Writable{address::kGainDb + 4, 0, kAny},
};

bool is_of_the_image(std::uint32_t at) {
  return at == address::kWidth || at == address::kHeight || at == address::kOffsetX || at == address::kOffsetY ||
         at == address::kPixelFormat;
}

}  // namespace

CameraRegisters::CameraRegisters(const CameraIdentity& identity)
    : sensor_width_(static_cast<std::uint32_t>(identity.width_px)),
      sensor_height_(static_cast<std::uint32_t>(identity.height_px)),
      bits_(identity.bits),
      memory_(kMemory, 0),
      description_(genicam_description(identity)) {
  describe_device(identity);
  set_word(address::kHeartbeatTimeoutMs, identity.heartbeat_timeout_ms);
  set_word(address::kPacketSize, kUsualPacket);
  set_word(address::kWidth, sensor_width_);
  set_word(address::kHeight, sensor_height_);
  set_word(address::kPixelFormat, sent_format(identity.pixel_format)->code);
  refresh_payload_size();
  set_number(address::kExposureUs, identity.shortest_exposure_us);
  set_number(address::kTemperatureC, identity.temperature_c.value_or(0.0));
}

void CameraRegisters::describe_device(const CameraIdentity& identity) {
  set_word(0x0000, 0x00020000);  // GigE Vision 2.0
  set_word(0x0004, 0x80000001);  // big endian, transmitter, UTF-8
  set_word(0x0010, 0x00000004);  // IP configuration: link local
  set_word(0x0014, 0x00000004);
  in_addr ip{};
  inet_pton(AF_INET, identity.address.c_str(), &ip);
  set_word(0x000C, 0x02000000U | (ntohl(ip.s_addr) & 0x00FFFFFFU));  // a locally administered MAC, one for each address
  set_word(0x0024, ntohl(ip.s_addr));
  set_word(0x0034, 0xFF000000);
  set_text(0x0048, 32, "Goniod");
  set_text(0x0068, 32, "Simulated camera");
  set_text(0x0088, 32, "1");
  set_text(0x00A8, 48, "goniosim");
  set_text(0x00D8, 16, identity.serial);
  set_text(0x0200, 512, fmt::format("Local:goniosim.xml;{:x};{:x}", address::kDescription, description_.size()));
  set_word(0x0600, 1);                // network interfaces
  set_word(0x0904, 1);                // stream channels
  set_word(0x0934, 0x7);              // concatenation, WRITEMEM, PACKETRESEND
  set_word(0x0940, kTicksPerSecond);  // low word
}

std::uint32_t CameraRegisters::word(std::uint32_t at) const {
  return get32(memory_, at);
}
void CameraRegisters::set_word(std::uint32_t at, std::uint32_t value) {
  put32(memory_, at, value);
}
double CameraRegisters::number(std::uint32_t at) const {
  return get_double(memory_, at);
}
void CameraRegisters::set_number(std::uint32_t at, double value) {
  put_double(memory_, at, value);
}

void CameraRegisters::set_text(std::uint32_t at, std::size_t room, const std::string& text) {
  const std::size_t length = std::min(text.size(), room - 1);
  std::fill_n(memory_.begin() + at, room, std::uint8_t{0});
  std::copy_n(text.begin(), length, memory_.begin() + at);
}

GvcpStatus CameraRegisters::read(std::uint32_t at, std::size_t count, std::vector<std::uint8_t>& out) const {
  const std::size_t padded = (description_.size() + 3) / 4 * 4;
  const bool in_description = at >= address::kDescription && at - address::kDescription + count <= padded;
  if (!in_description && std::size_t{at} + count > memory_.size()) return GvcpStatus::InvalidAddress;
  for (std::size_t k = at; k < at + count; ++k) {
    const std::size_t in_text = k - address::kDescription;
    if (!in_description)
      out.push_back(memory_[k]);
    else
      out.push_back(in_text < description_.size() ? static_cast<std::uint8_t>(description_[in_text]) : std::uint8_t{0});
  }
  return GvcpStatus::Success;
}

GvcpStatus CameraRegisters::check_write(std::uint32_t at, std::uint32_t value) const {
  if (at % 4 != 0) return GvcpStatus::BadAlignment;
  if (at + 4 > memory_.size()) return GvcpStatus::InvalidAddress;
  if (is_of_the_image(at)) return check_image(at, value);
  // A packet size comes with flags in its upper half.
  if (at == address::kPacketSize) {
    const std::uint32_t size = value & 0xFFFFU;
    return size >= kSmallestPacket && size <= kLargestPacket ? GvcpStatus::Success : GvcpStatus::InvalidParameter;
  }
  const auto* found = std::ranges::find(kWritable, at, &Writable::at);
  if (found == kWritable.end()) return GvcpStatus::WriteProtect;
  return value >= found->least && value <= found->most ? GvcpStatus::Success : GvcpStatus::InvalidParameter;
}

// Region and format stand still while frames are on their way. A region lies on the sensor: the offset first goes to 0
// where a larger one is wanted.
GvcpStatus CameraRegisters::check_image(std::uint32_t at, std::uint32_t value) const {
  if (word(address::kAcquisition) != 0) return GvcpStatus::AccessDenied;
  if (at == address::kPixelFormat) {
    const SentFormat* format = sent_format(value);
    return format != nullptr && format->bits == bits_ ? GvcpStatus::Success : GvcpStatus::InvalidParameter;
  }
  const bool is_x = at == address::kWidth || at == address::kOffsetX;
  const bool is_size = at == address::kWidth || at == address::kHeight;
  const std::uint32_t sensor = is_x ? sensor_width_ : sensor_height_;
  const std::uint32_t other =
      is_size ? word(is_x ? address::kOffsetX : address::kOffsetY) : word(is_x ? address::kWidth : address::kHeight);
  const bool fits = value <= sensor && other <= sensor - value && (!is_size || value >= kSmallestSide);
  return fits ? GvcpStatus::Success : GvcpStatus::InvalidParameter;
}

void CameraRegisters::refresh_payload_size() {
  const SentFormat* format = sent_format(word(address::kPixelFormat));
  set_word(address::kPayloadSize, payload_size(*format, word(address::kWidth) * word(address::kHeight)));
}

std::span<const std::uint8_t> CameraRegisters::discovery() const {
  return std::span(memory_).first(kDiscovery);
}

}  // namespace gonio::sim
