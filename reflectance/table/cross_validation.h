#pragma once

#include <cstddef>
#include <functional>

#include "base/geometry.h"
#include "base/units.h"
#include "reflectance/table/tabulated_surface.h"

namespace gonio::reflectance {

/// How far the readings are from what the others make of them.
struct CrossValidation {
  std::size_t count = 0;  ///< readings that the others could say something of
  Brdf rms{};             ///< of the differences, every reading counting alike
  Brdf most{};            ///< the largest of them
  Geometry worst{};       ///< where that was
  Brdf mean{};            ///< of |f| over the same readings, to compare with
};

/// Takes a pair of directions, the value there, and what the others make of it.
using ValidationVisitor = std::function<void(const Direction& i, const Direction& r, double f, double told)>;

/// All that `cross_validate_views` is made of.
void visit_view_errors(const TabulatedSurface& table, const ValidationVisitor& visit);
/// All that `cross_validate_incidences` is made of.
void visit_incidence_errors(const TabulatedSurface& table, const ValidationVisitor& visit);

/// Each reading against its neighbours of the same incidence, without itself; on rings the worse of along and across.
/// Noise included, and across a gap twice as wide as where the table is used: for a smooth surface some four times the
/// error between readings. Readings on the border have no neighbours all around and are left out.
[[nodiscard]] CrossValidation cross_validate_views(const TabulatedSurface& table);

/// Each incidence, other than the outermost, against what the table makes of it without: the error half-way between
/// incidences twice as far apart.
[[nodiscard]] CrossValidation cross_validate_incidences(const TabulatedSurface& table);

/// The readings under i against what those under r say of the same pair, Mobley (2005) eq 4, both where they are
/// covered: the interpolation's error and the sample's own, as `reciprocal` joins them.
[[nodiscard]] CrossValidation compare_both_ways(const TabulatedSurface& table);

}  // namespace gonio::reflectance
