#include "calibration/frame_reducer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gonio::calibration {
namespace {

// While a row is summed, the row so many pixels further on is called from memory: chords begin anew in each row, which
// a processor's own prefetcher does not foresee. With maps as many pixels are summed, then mapped: rows at hand and
// rows to come stay in the nearest cache.
constexpr std::size_t kPixelsAhead = 4096;

Error refusal(ErrorCode code, std::string seen, std::string limit) {
  return {
      .code = code, .device = "detector", .tried = "reduce frames", .seen = std::move(seen), .limit = std::move(limit)};
}

std::size_t count(int width, int height) {
  return width <= 0 || height <= 0 ? 0 : static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

Result<void> check_mask(int width, int height, const ApertureMask& mask) {
  // Negated, so that a NaN is refused too.
  const bool inside = mask.radius_px > 0.0 && mask.centre_x_px - mask.radius_px >= -0.5 &&
                      mask.centre_y_px - mask.radius_px >= -0.5 && mask.centre_x_px + mask.radius_px <= width - 0.5 &&
                      mask.centre_y_px + mask.radius_px <= height - 0.5;
  if (inside) return {};
  return failure(refusal(
      ErrorCode::OutOfLimits,
      fmt::format("an aperture of radius {} px about ({}, {}) px", mask.radius_px, mask.centre_x_px, mask.centre_y_px),
      fmt::format("a circle inside a frame of {} x {} pixels", width, height)));
}

Result<void> check_size(const DetectorMaps& maps, int width, int height) {
  const std::size_t pixels = count(width, height);
  const auto fits = [&](const auto& map) { return map.empty() || map.size() == pixels; };
  if (maps.width == width && maps.height == height && fits(maps.dark_offset_dn) && fits(maps.dark_rate_dn_per_s) &&
      fits(maps.flat) && fits(maps.linearity_1) && fits(maps.linearity_2) && fits(maps.bad)) {
    return {};
  }
  return failure(refusal(ErrorCode::InvalidInput, fmt::format("maps of {} x {} pixels", maps.width, maps.height),
                         fmt::format("{} x {}, each map whole or empty", width, height)));
}

float value_or(const std::vector<float>& map, std::size_t at, float fallback) {
  return map.empty() ? fallback : map[at];
}

}  // namespace

Result<FrameReducer> FrameReducer::prepare(int width, int height, std::uint16_t full_scale, const ApertureMask& mask,
                                           const std::optional<DetectorMaps>& maps, const DetectorModel& noise) {
  GONIO_TRY(check_mask(width, height, mask));
  FrameReducer reducer(width, height, full_scale);
  std::size_t longest = 1;
  for (int y = 0; y < height; ++y) {
    const double dy = y - mask.centre_y_px;
    const double half_width2 = mask.radius_px * mask.radius_px - dy * dy;
    if (half_width2 < 0.0) continue;
    const double half_width = std::sqrt(half_width2);
    const auto first = static_cast<std::ptrdiff_t>(std::ceil(mask.centre_x_px - half_width));
    const auto last = static_cast<std::ptrdiff_t>(std::floor(mask.centre_x_px + half_width));
    if (last < first) continue;
    const auto length = static_cast<std::size_t>(last - first + 1);
    reducer.chords_.push_back(
        {static_cast<std::size_t>(std::ptrdiff_t{y} * width + first), length, reducer.pixels_inside_});
    reducer.pixels_inside_ += length;
    longest = std::max(longest, length);
  }
  reducer.rows_ahead_ = std::max<std::size_t>(kPixelsAhead / longest, 1);
  if (maps) {
    GONIO_TRY(check_size(*maps, width, height));
    GONIO_TRY(reducer.take_maps(*maps, full_scale, noise));
  }
  if (reducer.pixels_inside_ > reducer.bad_.size()) return reducer;
  return failure(refusal(ErrorCode::OutOfLimits,
                         fmt::format("{} pixels inside an aperture of radius {} px, {} of them bad",
                                     reducer.pixels_inside_, mask.radius_px, reducer.bad_.size()),
                         "at least one that counts"));
}

Result<void> FrameReducer::take_maps(const DetectorMaps& maps, std::uint16_t full_scale, const DetectorModel& noise) {
  has_maps_ = true;
  is_curved_ = !maps.linearity_1.empty() || !maps.linearity_2.empty();
  version_ = maps.version;
  u_offset_ = maps.u_dark_offset_dn;
  u_rate_ = maps.u_dark_rate_dn_per_s;
  u_flat_ = maps.u_flat;
  electrons_per_dn_ = noise.electrons_per_dn;
  read_noise_dn_ = noise.read_noise_dn;
  const auto scale = static_cast<float>(full_scale);
  for (const Chord& chord : chords_) {
    for (std::size_t at = chord.first; at < chord.first + chord.length; ++at) {
      const bool is_bad = !maps.bad.empty() && maps.bad[at] != 0;
      if (is_bad) bad_.push_back(at);
      // A bad pixel's entries may be anything: it takes part in the loops with no weight.
      const auto take = [&](const std::vector<float>& map, float fallback) {
        return is_bad ? fallback : value_or(map, at, fallback);
      };
      const float offset = take(maps.dark_offset_dn, 0.0F);
      const float rate = take(maps.dark_rate_dn_per_s, 0.0F);
      const float flat = take(maps.flat, 1.0F);
      const float curve_1 = take(maps.linearity_1, 0.0F) / scale;
      const float curve_2 = take(maps.linearity_2, 0.0F) / (scale * scale);
      if (!(flat > 0.0F) || !std::isfinite(flat) || !std::isfinite(offset + rate + curve_1 + curve_2)) {
        return failure(refusal(ErrorCode::InvalidInput,
                               fmt::format("at pixel ({}, {}): dark {} DN, {} DN/s, flat {}, linearity {}, {}",
                                           at % static_cast<std::size_t>(width_), at / static_cast<std::size_t>(width_),
                                           offset, rate, flat, curve_1 * scale, curve_2 * scale * scale),
                               "finite numbers, a flat above 0, or the pixel marked as bad"));
      }
      offset_.push_back(offset);
      rate_.push_back(rate);
      weight_.push_back(is_bad ? 0.0F : 1.0F / flat);
      if (is_curved_) curve_1_.push_back(curve_1);
      if (is_curved_) curve_2_.push_back(curve_2);
      sum_weight2_ += double{weight_.back()} * double{weight_.back()};
    }
  }
  return {};
}

Result<ReducedFrame> FrameReducer::reduce(std::span<const std::uint16_t> pixels, double exposure_s,
                                          double gain_db) const {
  if (pixels.size() != count(width_, height_)) {
    return failure(refusal(ErrorCode::IncompleteData, fmt::format("{} pixels", pixels.size()),
                           fmt::format("{} x {} pixels", width_, height_)));
  }
  PowerSums sums;
  MapSums mapped;
  std::vector<std::span<const std::uint16_t>> rows;
  rows.reserve(chords_.size());
  for (const Chord& chord : chords_) rows.push_back(pixels.subspan(chord.first, chord.length));
  const std::size_t at_once = has_maps_ ? rows_ahead_ : rows.size();
  for (std::size_t from = 0; from < rows.size(); from += at_once) {
    const std::size_t end = std::min(from + at_once, rows.size());
    const PixelRows soon = PixelRows(rows).subspan(std::min(from + rows_ahead_, rows.size()));
    summer_.add(PixelRows(rows).subspan(from, end - from), soon, sums);
    for (std::size_t k = from; has_maps_ && k < end; ++k) {
      add_mapped(row_of(rows[k], chords_[k]), static_cast<float>(exposure_s), mapped);
    }
  }
  for (const std::size_t at : bad_) summer_.remove(pixels[at], sums);
  ReducedFrame frame{.raw = moments_of(sums), .bad = static_cast<std::uint32_t>(bad_.size()), .reduced = {}};
  if (has_maps_ && frame.raw.saturated == 0) frame.reduced = mean_of(mapped, frame.raw.n, exposure_s, gain_db);
  return frame;
}

MappedRow FrameReducer::row_of(std::span<const std::uint16_t> pixels, const Chord& chord) const {
  return {.pixels = pixels.data(),
          .offset = offset_.data() + chord.at,
          .rate = rate_.data() + chord.at,
          .weight = weight_.data() + chord.at,
          .curve_1 = is_curved_ ? curve_1_.data() + chord.at : nullptr,
          .curve_2 = is_curved_ ? curve_2_.data() + chord.at : nullptr,
          .n = chord.length};
}

// Shot noise goes with all that was collected, dark current too: pixel - offset. The maps' noise is independent from
// pixel to pixel: of the dark it enters through 1 / flat, of the flat in proportion to the pixel's own value.
ReducedMean FrameReducer::mean_of(const MapSums& sums, std::uint32_t pixels, double exposure_s, double gain_db) const {
  const double n = pixels;
  const double dn_per_electron = std::pow(10.0, gain_db / 20.0) / electrons_per_dn_;
  const double noise2 = read_noise_dn_ * read_noise_dn_ * sum_weight2_ + std::max(0.0, sums.light) * dn_per_electron;
  const double u_dark2 = u_offset_ * u_offset_ + std::pow(u_rate_ * exposure_s, 2);
  return {.n = pixels,
          .mean_dn = sums.value / n,
          .u_noise_dn = std::sqrt(noise2) / n,
          .u_maps_dn = std::sqrt(u_dark2 * sum_weight2_ + u_flat_ * u_flat_ * sums.value2) / n};
}

std::size_t FrameReducer::bytes_read() const {
  const std::size_t maps = !has_maps_ ? 0 : is_curved_ ? 5 : 3;
  return pixels_inside_ * (sizeof(std::uint16_t) + maps * sizeof(float));
}

}  // namespace gonio::calibration
