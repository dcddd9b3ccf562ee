#include "calibration/power_sums.h"

#include "calibration/power_kernel.h"

namespace gonio::calibration {

PowerSummer::PowerSummer(std::uint16_t full_scale) : full_scale_(full_scale), kernel_(&power_kernels().front()) {}

void PowerSummer::add(PixelRows rows, PixelRows soon, PowerSums& sums) const {
  kernel_->add(rows, soon, full_scale_, sums);
}

void PowerSummer::remove(std::uint16_t pixel, PowerSums& sums) const {
  const Wide d = pixel - kPowerShift;
  sums.n -= 1;
  sums.sum1 -= d;
  sums.sum2 -= d * d;
  sums.sum3 -= d * d * d;
  sums.sum4 -= d * d * d * d;
  sums.saturated -= pixel >= full_scale_ ? 1 : 0;
}

RegionMoments moments_of(const PowerSums& sums) {
  const Wide n = sums.n;
  const Wide k = (2 * sums.sum1 + (sums.sum1 >= 0 ? n : -n)) / (2 * n);  // the nearest whole DN
  const Wide s1 = sums.sum1 - n * k;
  const Wide s2 = sums.sum2 - 2 * k * sums.sum1 + n * k * k;
  const Wide s3 = sums.sum3 - 3 * k * sums.sum2 + 3 * k * k * sums.sum1 - n * k * k * k;
  const Wide s4 = sums.sum4 - 4 * k * sums.sum3 + 6 * k * k * sums.sum2 - 4 * k * k * k * sums.sum1 + n * k * k * k * k;
  const auto count = static_cast<double>(sums.n);
  const double rest = static_cast<double>(s1) / count;  // of the mean, at most half a DN
  const double p2 = static_cast<double>(s2) / count;
  const double p3 = static_cast<double>(s3) / count;
  const double p4 = static_cast<double>(s4) / count;
  const double rest2 = rest * rest;
  return {.n = static_cast<std::uint32_t>(sums.n),
          .mean = static_cast<double>(kPowerShift + static_cast<std::int64_t>(k)) + rest,
          .m2 = p2 - rest2,
          .m3 = p3 - 3.0 * rest * p2 + 2.0 * rest * rest2,
          .m4 = p4 - 4.0 * rest * p3 + 6.0 * rest2 * p2 - 3.0 * rest2 * rest2,
          .saturated = static_cast<std::uint32_t>(sums.saturated)};
}

}  // namespace gonio::calibration
