#include "drivers/genicam_camera/genicam_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/links/pixel_unpacking.h"

namespace gonio::drivers {
namespace {

constexpr int kMostStaleFrames = 64;
constexpr Duration kTemperatureAge = std::chrono::seconds(1);  // a housing does not warm faster than that
constexpr double kGainTolerance_db = 0.05;
constexpr std::uint64_t kLastShortId = 0xFFFF;  // GVSP block ids of 16 bits go from 65535 to 1 (GigE Vision 2.0, 24.3)

int significant_bits(const std::string& pixel_format) {
  const auto format = pixel_format_of_name(pixel_format);
  return format ? format->significant_bits : 0;
}

bool follows(std::uint64_t id, std::uint64_t last) {
  return id == last + 1 || (last == kLastShortId && id == 1);
}

// Cameras round to their own step; what was taken is what counts, as long as it is what was meant.
bool is_taken(const ExposureSettings& asked, const ExposureSettings& taken) {
  const Duration tolerance = std::max<Duration>(std::chrono::microseconds(1), asked.exposure / 1000);
  const Duration off = taken.exposure - asked.exposure;
  return off <= tolerance && -off <= tolerance && std::abs(taken.gain_db - asked.gain_db) <= kGainTolerance_db;
}

std::string text(const ExposureSettings& settings) {
  return fmt::format("exposure {:.6f} s, gain {:.2f} dB", in_seconds(settings.exposure), settings.gain_db);
}

std::string text(const CameraFormat& format) {
  return fmt::format("{} x {} px from ({}, {}), {}, packets of {} bytes", format.width, format.height, format.offset_x,
                     format.offset_y, format.pixel_format, format.packet_size_bytes);
}

}  // namespace

GenicamCamera::GenicamCamera(CameraLink& link, GenicamCameraConfig config, const Clock& clock)
    : link_(link), config_(std::move(config)), clock_(clock), wanted_(config_.settings) {}

Error GenicamCamera::error(ErrorCode code, std::string tried, std::string seen, std::string limit) const {
  return {.code = code,
          .device = "detector",
          .tried = std::move(tried),
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

Result<DetectorIdentity> GenicamCamera::ensure_open() {
  if (is_ready_ && link_.is_open() && !link_.has_lost_control()) return identity_;
  is_ready_ = false;
  triggered_.reset();
  if (Result<void> opened = open(); !opened) {
    link_.close();
    return failure(std::move(opened).error());
  }
  is_ready_ = true;
  return identity_;
}

Result<void> GenicamCamera::open() {
  Result<DetectorIdentity> who = link_.open();
  if (!who) return failure(std::move(who).error());
  if (who->serial != config_.serial) {
    return failure(error(ErrorCode::WrongDevice, "open the camera", fmt::format("serial {}", who->serial),
                         fmt::format("serial {}", config_.serial)));
  }
  identity_ = *who;
  GONIO_TRY(write_format());
  GONIO_TRY(write_exposure(wanted_));
  temperature_at_.reset();
  return restart_stream();
}

Result<void> GenicamCamera::write_format() {
  if (significant_bits(config_.format.pixel_format) == 0) {
    return failure(error(ErrorCode::InvalidInput, "set the pixel format", config_.format.pixel_format,
                         "one of " + pixel_format_names()));
  }
  GONIO_TRY(link_.set_format(config_.format));
  const Result<CameraFormat> taken = link_.format();
  if (!taken) return failure(taken.error());
  if (*taken == config_.format) return {};
  return failure(error(ErrorCode::SettingNotTaken, "set " + text(config_.format), text(*taken)));
}

Result<void> GenicamCamera::write_exposure(const ExposureSettings& settings) {
  GONIO_TRY(link_.set_exposure(settings));
  const Result<ExposureSettings> taken = link_.exposure();
  if (!taken) return failure(taken.error());
  if (!is_taken(settings, *taken)) {
    return failure(error(ErrorCode::SettingNotTaken, "set " + text(settings), text(*taken)));
  }
  wanted_ = settings;
  taken_ = *taken;
  return {};
}

Result<void> GenicamCamera::restart_stream() {
  link_.stop();
  last_id_.reset();
  last_time_ns_ = 0;
  GONIO_TRY(link_.start());
  needs_new_stream_ = false;
  return {};
}

Result<void> GenicamCamera::apply(const ExposureSettings& settings) {
  if (const auto opened = ensure_open(); !opened) return failure(opened.error());
  if (settings == wanted_) return {};
  return write_exposure(settings);
}

Result<void> GenicamCamera::trigger() {
  if (const auto opened = ensure_open(); !opened) return failure(opened.error());
  triggered_.reset();
  if (needs_new_stream_) GONIO_TRY(restart_stream());
  GONIO_TRY(drain());
  GONIO_TRY(refresh_temperature(clock_.now()));
  triggered_ = clock_.now();
  if (Result<void> sent = link_.trigger(); !sent) {
    triggered_.reset();
    needs_new_stream_ = true;  // it may have been heard all the same
    return sent;
  }
  return {};
}

Result<void> GenicamCamera::drain() {
  for (int i = 0; i < kMostStaleFrames; ++i) {
    const auto stale = link_.pop(Duration::zero());
    if (!stale) return failure(stale.error());
    if (!*stale) return {};
    last_id_ = (*stale)->frame_id;
    last_time_ns_ = (*stale)->camera_time_ns;
  }
  needs_new_stream_ = true;
  return failure(
      error(ErrorCode::StaleData, "trigger", fmt::format("more than {} frames without a trigger", kMostStaleFrames)));
}

Result<std::optional<Frame>> GenicamCamera::collect(Duration wait) {
  if (!triggered_) return failure(error(ErrorCode::WrongState, "fetch a frame", "none was triggered"));
  const Instant deadline = *triggered_ + taken_.exposure + config_.frame_margin;
  const Duration patience = std::clamp(deadline - clock_.now(), Duration::zero(), std::max(wait, Duration::zero()));
  Result<std::optional<CameraFrame>> popped = link_.pop(patience);
  if (!popped) {
    triggered_.reset();
    needs_new_stream_ = true;
    return failure(std::move(popped).error());
  }
  const Instant now = clock_.now();
  if (!*popped) {
    if (now < deadline) return std::optional<Frame>();
    triggered_.reset();
    needs_new_stream_ = true;
    return failure(
        error(ErrorCode::TimedOut, "fetch the frame of " + text(taken_), "no frame",
              fmt::format("{:.3f} s after the trigger", in_seconds(taken_.exposure + config_.frame_margin))));
  }
  triggered_.reset();
  auto frame = accepted(std::move(**popped), now);
  if (!frame) return failure(std::move(frame).error());
  return std::optional<Frame>(std::move(*frame));
}

Result<Frame> GenicamCamera::accepted(CameraFrame frame, Instant now) {
  const std::string tried = "fetch the frame of " + text(taken_);
  if (last_id_ && !follows(frame.frame_id, *last_id_)) {
    needs_new_stream_ = true;
    return failure(error(ErrorCode::StaleData, tried, fmt::format("frame {}", frame.frame_id),
                         fmt::format("the one after {}", *last_id_)));
  }
  last_id_ = frame.frame_id;
  if (!frame.is_complete) {
    return failure(error(ErrorCode::IncompleteData, tried, fmt::format("frame {}: {}", frame.frame_id, frame.trouble)));
  }
  // Two exposures do not end at once: this is the light of the frame before under a number of its own.
  if (frame.camera_time_ns != 0 && frame.camera_time_ns == last_time_ns_) {
    needs_new_stream_ = true;
    return failure(
        error(ErrorCode::StaleData, tried, fmt::format("frame {} bears the time of the frame before", frame.frame_id)));
  }
  last_time_ns_ = frame.camera_time_ns;
  if (frame.width != config_.format.width || frame.height != config_.format.height) {
    return failure(error(ErrorCode::IncompleteData, tried, fmt::format("{} x {} px", frame.width, frame.height),
                         fmt::format("{} x {} px", config_.format.width, config_.format.height)));
  }
  return Frame{.width = frame.width,
               .height = frame.height,
               .significant_bits = significant_bits(config_.format.pixel_format),
               .pixels = std::move(frame.pixels),
               .frame_id = frame.frame_id,
               .camera_time_ns = frame.camera_time_ns,
               .settings = taken_,
               .temperature_c = temperature_c_,
               .arrived = now};
}

Result<void> GenicamCamera::refresh_temperature(Instant now) {
  if (temperature_at_ && now - *temperature_at_ < kTemperatureAge) return {};
  const Result<std::optional<double>> read = link_.temperature_c();
  if (!read && read.error().code != ErrorCode::DeviceRefused) return failure(read.error());
  temperature_c_ = read.value_or(std::nullopt);  // what it will not tell at this moment it does not have
  temperature_at_ = now;
  return {};
}

}  // namespace gonio::drivers
