#pragma once

#include <cstdint>

#include "base/units.h"
#include "reflectance/table/tabulated_surface.h"

namespace gonio::reflectance {

/// Where a pair of directions lies, seen from a table's readings.
enum class TablePlace : std::uint8_t {
  Within,            ///< `covers` holds
  BeyondIncidences,  ///< beyond the outermost incidences, or between two that lie farther apart than declared
  BeyondViews,       ///< beyond the outermost views of an incidence that counts
  InAHole,           ///< in a cell that is wider than declared
};

/// Without reciprocal mixing.
[[nodiscard]] TablePlace place_in(const TabulatedSurface& table, const Direction& i, const Direction& r);

/// What a value that is read off a table between its readings is worth (k = 1): 0 at a reading.
///
/// Linear interpolation over a step h errs by f'' h^2 t (1 - t) / 2 at a part t of it; over a cell with the weights w
/// by e (1 - sum of w^2) / 2, where e is how far a node lies off the plane through its neighbours: exact for f'' h^2 /
/// 2 in the middle of a step, and in that of a triangle. So e is measured, without a derivative: as the largest
/// distance of the nodes across a triangle's three sides from the triangle continued to there; on rings as that of a
/// node from what its neighbours along and across make of it; between incidences as that of an incidence from what
/// those on both its sides make of the view. Where there are no such neighbours e is the range of the values in the
/// cell. An incidence that was made for the normal is worth what it differs from the first that was measured. Noise is
/// in e, and makes the statement larger. Views and incidences add in quadrature.
///
/// In cells of any width; beyond the readings' reach that of the nearest place within. Without reciprocal mixing.
[[nodiscard]] Brdf interpolation_uncertainty(const TabulatedSurface& table, const Direction& i, const Direction& r);

}  // namespace gonio::reflectance
