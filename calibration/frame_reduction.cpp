#include "calibration/frame_reduction.h"

#include <fmt/format.h>

#include <cmath>

namespace gonio::calibration {
namespace {

/// Counts and sums of central powers; `sum_k` = sum (x - mean)^k, from which moments of a union follow without the
/// data.
struct CentralSums {
  double n = 0.0;
  double mean = 0.0;
  double sum2 = 0.0;
  double sum3 = 0.0;
  double sum4 = 0.0;
};

// Two passes over one row, which the first leaves in the cache: the mean, then powers about it.
CentralSums central_sums(std::span<const std::uint16_t> row) {
  std::uint64_t total = 0;  // 2^48 pixels would overflow it
  for (const std::uint16_t pixel : row) total += pixel;
  CentralSums s{.n = static_cast<double>(row.size())};
  s.mean = static_cast<double>(total) / s.n;
  for (const std::uint16_t pixel : row) {
    const double d = pixel - s.mean;
    const double d2 = d * d;
    s.sum2 += d2;
    s.sum3 += d2 * d;
    s.sum4 += d2 * d2;
  }
  return s;
}

// Pebay 2008, "Formulas for Robust, One-Pass Parallel Computation of Covariances and Arbitrary-Order Statistical
// Moments", SAND2008-6212, section 2: moments of the union of two sets.
CentralSums merged(const CentralSums& a, const CentralSums& b) {
  if (a.n == 0.0) return b;
  const double n = a.n + b.n;
  const double d = b.mean - a.mean;
  const double d_n = d / n;
  const double ab = a.n * b.n;
  CentralSums u{.n = n, .mean = a.mean + b.n * d_n};
  u.sum2 = a.sum2 + b.sum2 + ab * d * d_n;
  u.sum3 = a.sum3 + b.sum3 + ab * (a.n - b.n) * d * d_n * d_n + 3.0 * (a.n * b.sum2 - b.n * a.sum2) * d_n;
  u.sum4 = a.sum4 + b.sum4 + ab * (a.n * a.n - ab + b.n * b.n) * d * d_n * d_n * d_n +
           6.0 * (a.n * a.n * b.sum2 + b.n * b.n * a.sum2) * d_n * d_n + 4.0 * (a.n * b.sum3 - b.n * a.sum3) * d_n;
  return u;
}

Result<void> check(std::size_t pixels, int width, int height, const ApertureMask& mask) {
  if (width <= 0 || height <= 0 || pixels != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    return failure({.code = ErrorCode::IncompleteData,
                    .device = "detector",
                    .tried = "reduce a frame",
                    .seen = fmt::format("{} pixels", pixels),
                    .limit = fmt::format("{} x {} pixels", width, height)});
  }
  // Negated, so that a NaN is refused too.
  const bool inside = mask.radius_px > 0.0 && mask.centre_x_px - mask.radius_px >= -0.5 &&
                      mask.centre_y_px - mask.radius_px >= -0.5 && mask.centre_x_px + mask.radius_px <= width - 0.5 &&
                      mask.centre_y_px + mask.radius_px <= height - 0.5;
  if (inside) return {};
  return failure({.code = ErrorCode::OutOfLimits,
                  .device = "detector",
                  .tried = "reduce a frame",
                  .seen = fmt::format("an aperture of radius {} px about ({}, {}) px", mask.radius_px, mask.centre_x_px,
                                      mask.centre_y_px),
                  .limit = fmt::format("a circle inside a frame of {} x {} pixels", width, height)});
}

}  // namespace

Result<RegionMoments> reduce_frame(std::span<const std::uint16_t> pixels, int width, int height,
                                   std::uint16_t full_scale, const ApertureMask& mask) {
  GONIO_TRY(check(pixels.size(), width, height, mask));
  CentralSums all;
  std::uint32_t saturated = 0;
  for (int y = 0; y < height; ++y) {
    const double dy = y - mask.centre_y_px;
    const double half_width2 = mask.radius_px * mask.radius_px - dy * dy;
    if (half_width2 < 0.0) continue;
    const double half_width = std::sqrt(half_width2);
    const auto first = static_cast<std::ptrdiff_t>(std::ceil(mask.centre_x_px - half_width));
    const auto last = static_cast<std::ptrdiff_t>(std::floor(mask.centre_x_px + half_width));
    if (last < first) continue;
    const auto row = pixels.subspan(static_cast<std::size_t>(std::ptrdiff_t{y} * width + first),
                                    static_cast<std::size_t>(last - first + 1));
    for (const std::uint16_t pixel : row) saturated += pixel >= full_scale ? 1U : 0U;
    all = merged(all, central_sums(row));
  }
  if (all.n == 0.0)
    return failure({.code = ErrorCode::OutOfLimits,
                    .device = "detector",
                    .tried = "reduce a frame",
                    .seen = fmt::format("an aperture of radius {} px", mask.radius_px),
                    .limit = "at least one pixel's centre inside"});
  return RegionMoments{.n = static_cast<std::uint32_t>(all.n),
                       .mean = all.mean,
                       .m2 = all.sum2 / all.n,
                       .m3 = all.sum3 / all.n,
                       .m4 = all.sum4 / all.n,
                       .saturated = saturated};
}

}  // namespace gonio::calibration
