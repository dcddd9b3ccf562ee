#include "calibration/linearity.h"

#include <algorithm>

namespace gonio::calibration {

LinearityPowers linearity_powers(double net, double full_scale, const RegionMoments* region) {
  const RegionMoments none;
  const RegionMoments& m = region != nullptr ? *region : none;
  const double square = net * net + m.m2;
  const double cube = net * (net * net + 3.0 * m.m2) + m.m3;
  const double fourth = net * net * (net * net + 6.0 * m.m2) + 4.0 * net * m.m3 + m.m4;
  const double per = 1.0 / full_scale;
  return {square * per, cube * per * per, fourth * per * per * per};
}

double linearity_gain(const LinearityModel& model, const LinearityPowers& powers) {
  const std::size_t n = std::min(model.coefficients.size(), powers.size());
  double sum = 0.0;
  for (std::size_t k = 0; k < n; ++k) sum += model.coefficients[k] * powers[k];
  return sum;
}

}  // namespace gonio::calibration
