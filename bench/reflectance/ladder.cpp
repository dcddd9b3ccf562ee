#include "bench/reflectance/ladder.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonio::bench {

const Step* first_within(const Ladder& ladder, double error) {
  const Step* first = nullptr;
  for (auto step = ladder.rbegin(); step != ladder.rend() && step->error <= error; ++step) first = &*step;
  return first;
}

double interpolated_seconds(const Ladder& ladder, double error) {
  const Step* reached = first_within(ladder, error);
  if (reached == nullptr) return std::numeric_limits<double>::quiet_NaN();
  if (reached == ladder.data()) return reached->seconds;
  const Step& before = *(reached - 1);
  const double reached_error = std::max(reached->error, 1e-16);
  const double part = std::log(before.error / error) / std::log(before.error / reached_error);
  return before.seconds * std::pow(reached->seconds / before.seconds, part);
}

}  // namespace gonio::bench
