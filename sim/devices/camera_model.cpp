#include "sim/devices/camera_model.h"

#include <fmt/format.h>

namespace gonio::sim {
namespace {

Error refused(std::string tried, std::string limit) {
  return {.code = ErrorCode::OutOfLimits,
          .device = "camera",
          .tried = std::move(tried),
          .seen = {},
          .limit = std::move(limit)};
}

}  // namespace

// The register holds whole nanoseconds at best: a rung of the ladder that rounding moved is still inside the limits.
CameraModel::CameraModel(Instrument& instrument)
    : instrument_(instrument),
      shortest_(instrument.scene().wall(instrument.scene().detector.shortest_exposure_s) - Duration(1)),
      longest_(instrument.scene().wall(instrument.scene().detector.longest_exposure_s) + Duration(1)),
      exposure_(shortest_ + Duration(1)) {}

Result<void> CameraModel::set_exposure(Duration exposure) {
  if (exposure < shortest_ || exposure > longest_) {
    return failure(refused(fmt::format("set the exposure to {:.9f} s", in_seconds(exposure)),
                           fmt::format("{:.9f} s to {:.9f} s", in_seconds(shortest_), in_seconds(longest_))));
  }
  exposure_ = exposure;
  return {};
}

Result<void> CameraModel::set_gain(double gain_db) {
  if (!(gain_db >= 0.0 && gain_db <= kMostGainDb)) {
    return failure(refused(fmt::format("set the gain to {} dB", gain_db), fmt::format("0 dB to {} dB", kMostGainDb)));
  }
  gain_db_ = gain_db;
  return {};
}

bool CameraModel::trigger(Instant now) {
  return instrument_.start_exposure(exposure_, gain_db_, now);
}

std::optional<Exposure> CameraModel::collect_exposure(Instant now) {
  auto exposure = instrument_.take_exposure(now);
  if (exposure) ++frames_;
  return exposure;
}

CameraFrame make_frame(const Scene& scene, const Exposure& exposure, std::uint64_t frame_id) {
  return {.width = scene.detector.width_px,
          .height = scene.detector.height_px,
          .pixels = render_frame(scene.detector, exposure, scene.seed),
          .frame_id = frame_id,
          .exposure_end = exposure.close,
          .exposure = exposure.close - exposure.open,
          .gain_db = exposure.gain_db};
}

std::optional<CameraFrame> CameraModel::collect(Instant now) {
  const auto exposure = collect_exposure(now);
  if (!exposure) return std::nullopt;
  return make_frame(instrument_.scene(), *exposure, frames_);
}

}  // namespace gonio::sim
