#pragma once

#include <algorithm>

namespace gonio::reflectance {

/// How far a point value may lie from the truth, relative: 1e-14, or what four roundings of the inputs do to it.
/// `condition` is the sum over the inputs x of |x f'(x) / f|: beside the horizon or on a narrow lobe the nearest double
/// to the angle alone moves f by more than 1e-14.
[[nodiscard]] inline double point_tolerance(double condition) {
  return std::max(1e-14, 4.0 * condition * 0x1p-53);
}

}  // namespace gonio::reflectance
