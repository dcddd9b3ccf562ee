#pragma once

#include "base/geometry.h"
#include "base/units.h"

namespace gonio::reflectance {

/// One value of a measured BRDF. `f` may be negative, as a noisy dark sample reads now and then; `f.u` is its standard
/// uncertainty (k = 1), 0 where none is known.
struct TableReading {
  Geometry geometry;
  Measured<Brdf> f;
};

}  // namespace gonio::reflectance
