#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "base/units.h"

namespace gonio::calibration {

/// One place on a line across a beam.
struct CrossingPlace {
  double at = 0.0;  ///< rad, along the line
  double q = 0.0;   ///< signed
  double u = 0.0;   ///< of q, random
};

/// How wide a crossing is where the light is half of its middle's.
struct CrossingWidth {
  Measured<Angle> width;          ///< full width at half maximum
  Measured<Angle> centre;         ///< the middle between the two half-level places
  double level = 0.0;             ///< q of the middle
  std::vector<double> dwidth_dq;  ///< rad, of each place as given: what errors in common do
  std::vector<double> dcentre_dq;
};

/// The half-level places lie on the straight line between the two readings about each; the middle's level is the one
/// half way between them, likewise (in a few rounds, since each follows from the other). u: of the readings' noise and
/// of `u_pointing` (k = 1, each place its own), which tells through the crossing's slope; and of the line's bend
/// between two readings, by second differences, as a rectangle. `places`: any order. `tried` is what an error says was
/// tried. Errors: IncompleteData (fewer than five places; no light; a tenth or more of the middle's light still there
/// at an end; fewer than three readings on a flank, between 5 % and 95 % of the middle, which tell an edge from a
/// step).
[[nodiscard]] Result<CrossingWidth> crossing_width(std::span<const CrossingPlace> places, Angle u_pointing,
                                                   std::string_view tried);

}  // namespace gonio::calibration
