#pragma once

#include <functional>
#include <optional>

#include "reflectance/integral/integral.h"
#include "reflectance/light/sky.h"

namespace gonio::reflectance {

/// integral over the upper hemisphere of h(i) mu_i dOmega_i where h is smooth within each cell of the sky's own grid
/// but for a kink or a peak at `hard`. The cell that is least well known is halved both ways until what all of them
/// miss is below `relative_tolerance` or 4e6 evaluations are spent; cells at `hard` are halved ten times beforehand, so
/// that a peak between nodes is found. A cell's error is the difference of its Gauss rules of 3 x 3 and 5 x 5.
[[nodiscard]] Integral integrate_cells(const Sky& sky, const std::optional<Direction>& hard,
                                       const std::function<double(const Direction&)>& h, double relative_tolerance);

}  // namespace gonio::reflectance
