#pragma once

#include "sim/scene/effects_spec.h"

namespace gonio::sim {

/// The curve of a detector at `x` of full scale:
///   y = x (1 + quadratic x + cubic x^2);  above the knee k: k + (s - k)(1 - exp(-(y - k)/(s - k))), s the saturation
/// with slope 1 at the knee. 0 at 0.
[[nodiscard]] double response(const ResponseSpec& spec, double x);

}  // namespace gonio::sim
