#pragma once

#include <span>

#include "reflectance/table/table_row.h"

namespace gonio::reflectance {

/// What stands out in the rows: readings within 10 deg of the retro direction, or of the mirror direction, brighter by
/// near - far > 0.05 (|near| + |far|) than those 15 to 35 deg away, summed over the incidences from 10 deg on (below,
/// the two cannot be told apart). Where both stand out, as on a glossy retro-reflector, the one with the greater near -
/// far.
struct DetectedFeature {
  Feature feature = Feature::Smooth;
  bool is_double = false;  ///< the other one stands out too
};
[[nodiscard]] DetectedFeature detected_feature(std::span<const TableRow> rows);

}  // namespace gonio::reflectance
