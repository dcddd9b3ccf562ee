#pragma once

#include <span>

#include "reflectance/table/table_row.h"

namespace gonio::reflectance {

/// What stands out in the rows: how much brighter it is within 10 deg of the retro direction, or of the mirror
/// direction, than 15 to 35 deg away, (near - far) / (|near| + |far|), averaged over the incidences from 10 deg on.
/// The stronger one is the feature when it exceeds 0.05. Below 10 deg the two cannot be told apart.
[[nodiscard]] Feature detected_feature(std::span<const TableRow> rows);

}  // namespace gonio::reflectance
