#pragma once

#include <span>

#include "base/result.h"
#include "reflectance/table/tabulated_surface.h"

namespace gonio::reflectance {

/// A table of readings whose layout nobody declared: scattered, and on rings where all of an incidence's lie in one
/// plane (which leaves the azimuths between uncovered). `options.layout` is overruled. Errors: as
/// TabulatedSurface::make.
[[nodiscard]] Result<TabulatedSurface> table_of_readings(std::span<const TableReading> readings, TableOptions options);

}  // namespace gonio::reflectance
