#include "calibration/jobs/pixel_sums.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gonio::calibration {
namespace {

Error refusal(std::string seen, std::string limit) {
  return {.code = ErrorCode::IncompleteData,
          .device = "detector",
          .tried = "sum frames pixel by pixel",
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

std::string text_of(const PixelBox& box, Duration exposure, double gain_db) {
  return fmt::format("{} x {} pixels at ({}, {}) of {} x {}, {} s, {} dB", box.columns, box.rows, box.left, box.top,
                     box.width, box.height, in_seconds(exposure), gain_db);
}

}  // namespace

PixelBox box_about(const ApertureMask& mask, int width, int height) {
  const auto first = [](double centre, double radius) {
    return std::max(0, static_cast<int>(std::floor(centre - radius)) - 1);
  };
  const auto end = [](double centre, double radius, int side) {
    return std::min(side, static_cast<int>(std::ceil(centre + radius)) + 2);
  };
  PixelBox box{.width = width, .height = height};
  box.left = first(mask.centre_x_px, mask.radius_px);
  box.top = first(mask.centre_y_px, mask.radius_px);
  box.columns = std::max(0, end(mask.centre_x_px, mask.radius_px, width) - box.left);
  box.rows = std::max(0, end(mask.centre_y_px, mask.radius_px, height) - box.top);
  return box;
}

Result<void> add_frame(PixelSums& sums, const PixelFrame& frame, const ApertureMask& mask) {
  const PixelBox box = box_about(mask, frame.width, frame.height);
  const bool is_whole =
      frame.pixels.size() == static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  const bool is_same =
      sums.frames == 0 || (sums.box == box && sums.exposure == frame.exposure && sums.gain_db == frame.gain_db);
  if (!is_whole || !is_same) {
    return failure(refusal(
        fmt::format("a frame of {} values: {}", frame.pixels.size(), text_of(box, frame.exposure, frame.gain_db)),
        sums.frames == 0 ? "width x height values" : text_of(sums.box, sums.exposure, sums.gain_db)));
  }
  if (sums.frames == 0) {
    sums = {.box = box, .exposure = frame.exposure, .gain_db = frame.gain_db};
    sums.sum.assign(box.size(), 0.0);
    sums.sum2.assign(box.size(), 0.0);
  }
  std::size_t at = 0;
  for (int row = 0; row < box.rows; ++row) {
    const std::size_t begin = static_cast<std::size_t>(box.top + row) * static_cast<std::size_t>(box.width) +
                              static_cast<std::size_t>(box.left);
    for (const std::uint16_t pixel : frame.pixels.subspan(begin, static_cast<std::size_t>(box.columns))) {
      const auto value = static_cast<double>(pixel);
      sums.sum[at] += value;
      sums.sum2[at] += value * value;
      ++at;
    }
  }
  ++sums.frames;
  return {};
}

Result<void> PixelStack::add(const PixelSums& sums) {
  const std::size_t n = sums.box.size();
  const bool is_whole = sums.frames > 0 && n > 0 && sums.sum.size() == n && sums.sum2.size() == n;
  const bool is_same = readings_ == 0 || (sums.box == box_ && sums.exposure == exposure_ && sums.gain_db == gain_db_);
  if (!is_whole || !is_same) {
    return failure(refusal(fmt::format("{} frames in {} and {} sums: {}", sums.frames, sums.sum.size(),
                                       sums.sum2.size(), text_of(sums.box, sums.exposure, sums.gain_db)),
                           readings_ == 0 ? "a sum for each pixel" : text_of(box_, exposure_, gain_db_)));
  }
  if (readings_ == 0) {
    box_ = sums.box;
    exposure_ = sums.exposure;
    gain_db_ = sums.gain_db;
    sum_.assign(n, 0.0);
    within_.assign(n, 0.0);
  }
  const auto frames = static_cast<double>(sums.frames);
  for (std::size_t k = 0; k < n; ++k) {
    sum_[k] += sums.sum[k];
    within_[k] += std::max(0.0, sums.sum2[k] - sums.sum[k] * sums.sum[k] / frames);
  }
  frames_ += sums.frames;
  ++readings_;
  return {};
}

}  // namespace gonio::calibration
