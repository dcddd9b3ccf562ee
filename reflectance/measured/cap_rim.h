#pragma once

#include <vector>

#include "reflectance/measured/cap_model.h"
#include "reflectance/measured/pair_nodes.h"

namespace gonio::reflectance {

/// A term of an integral where readings are.
struct SeenNode {
  PairNode node;
  double term = 0.0;  ///< by the readings, weight included
};

/// How much surfaces count that none of them holds (CapModel::u_lack_of_fit), where nothing was measured.
struct CapDoubt {
  double u_relative = 0.0;            ///< of what the cap gives, one sign over all of it
  std::vector<double> rival_weights;  ///< with that of the cap itself they sum to 1
};

/// Looks at the last 20 deg of what was measured, next to what was not, and there at four integrals: near and far,
/// before and behind the normal, so that the readings of a lobe count as what they are worth. What the cap is off there
/// goes on; its rivals count by how little they are off themselves. Without a node the cap's own word stands.
[[nodiscard]] CapDoubt doubt_of(const CapModel& cap, const std::vector<SeenNode>& seen);

}  // namespace gonio::reflectance
