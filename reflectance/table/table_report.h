#pragma once

#include <cstddef>
#include <vector>

#include "base/geometry.h"

namespace gonio::reflectance {

/// Several readings of one direction that were made one: their mean, weighted by 1/u^2 where each has a u.
struct MergedReadings {
  Geometry geometry;               ///< of the first
  std::size_t count = 0;           ///< how many
  double largest_deviation = 0.0;  ///< from the mean, in standard uncertainties of the reading; 0 where no u is known
  bool disagree = false;           ///< `largest_deviation` is above 3: the mean's u was widened by the Birge ratio
};

/// What became of the readings of a table.
struct TableReport {
  std::size_t readings = 0;
  std::size_t directions = 0;  ///< after merging, over all incidences
  std::size_t incidences = 0;
  std::vector<MergedReadings> merged;
  std::size_t disagreeing = 0;  ///< of `merged`
};

}  // namespace gonio::reflectance
