#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "calibration/aperture_mask.h"

namespace gonio::calibration {

/// The square about an aperture, one pixel wider on each side and cut at the frame's edges: what a job keeps of frames.
struct PixelBox {
  int width = 0;  ///< of the frame
  int height = 0;
  int left = 0;  ///< of the square, from the frame's top left
  int top = 0;
  int columns = 0;
  int rows = 0;
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  friend bool operator==(const PixelBox&, const PixelBox&) = default;
};
[[nodiscard]] PixelBox box_about(const ApertureMask& mask, int width, int height);

/// Frames of one exposure and gain, added pixel by pixel: whole numbers, exact as doubles for 2^21 frames of 16 bits.
struct PixelSums {
  PixelBox box;
  Duration exposure{};
  double gain_db = 0.0;
  std::int64_t frames = 0;
  std::vector<double> sum;   ///< [rows][columns], DN
  std::vector<double> sum2;  ///< likewise, DN^2
  friend bool operator==(const PixelSums&, const PixelSums&) = default;
};

/// A frame as its camera gave it: [height][width], top left first.
struct PixelFrame {
  std::span<const std::uint16_t> pixels;
  int width = 0;
  int height = 0;
  Duration exposure{};
  double gain_db = 0.0;
};

/// Adds a frame; the first one fixes size, exposure and gain. Errors: IncompleteData (another size or setting than the
/// frames before, or not width x height pixels); nothing is added then.
[[nodiscard]] Result<void> add_frame(PixelSums& sums, const PixelFrame& frame, const ApertureMask& mask);

/// Sums of several readings at one exposure. The scatter is that within each of them: what lamp or dark level do
/// between readings is no noise of a pixel.
class PixelStack {
 public:
  /// Errors: IncompleteData (another square, exposure or gain than before, or damaged: sums of another size).
  [[nodiscard]] Result<void> add(const PixelSums& sums);

  [[nodiscard]] const PixelBox& box() const { return box_; }
  [[nodiscard]] Duration exposure() const { return exposure_; }
  [[nodiscard]] std::int64_t frames() const { return frames_; }
  [[nodiscard]] std::int64_t degrees_of_freedom() const { return frames_ - readings_; }
  [[nodiscard]] double sum(std::size_t pixel) const { return sum_[pixel]; }
  [[nodiscard]] double mean(std::size_t pixel) const { return sum_[pixel] / static_cast<double>(frames_); }
  /// Of one frame. Needs a degree of freedom.
  [[nodiscard]] double variance(std::size_t pixel) const {
    return within_[pixel] / static_cast<double>(degrees_of_freedom());
  }

 private:
  PixelBox box_;
  Duration exposure_{};
  double gain_db_ = 0.0;
  std::int64_t frames_ = 0;
  std::int64_t readings_ = 0;
  std::vector<double> sum_;
  std::vector<double> within_;  ///< sums of squares about each reading's own mean
};

}  // namespace gonio::calibration
