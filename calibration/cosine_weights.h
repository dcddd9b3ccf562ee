#pragma once

#include <vector>

#include "base/units.h"

namespace gonio::calibration {

/// The integral of each node's hat function (1 there, 0 at the neighbours, straight between) with sin theta cos theta,
/// between the first node and the last: weights that are exact for what is linear between the nodes. `grid` ascends.
[[nodiscard]] std::vector<double> cosine_weights(const std::vector<Angle>& grid);

}  // namespace gonio::calibration
