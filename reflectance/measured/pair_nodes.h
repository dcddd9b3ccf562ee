#pragma once

#include <vector>

#include "base/result.h"
#include "reflectance/direction/direction_pair.h"
#include "reflectance/integral/hemisphere_integral.h"
#include "reflectance/light/light.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// One term of an integral over a BRDF: weight x f(i, r).
struct PairNode {
  DirectionPair pair;
  double weight = 0.0;
};

/// How finely to integrate; the difference of the two is taken for the error of the finer.
enum class NodeLevel : std::uint8_t { Coarse, Fine };

/// Directions over the hemisphere with their mu dOmega, in polar coordinates about what stands out under `axis`
/// (itself for a hot spot, its mirror direction for a lobe, the normal else) and dense there and at the horizon: 1152
/// or 2400 of them.
[[nodiscard]] std::vector<HemisphereNode> feature_nodes(const Direction& axis, Feature feature, NodeLevel level);

/// The zenith angles (at phi = 0, or 8 azimuths each of an anisotropic surface) over which a quantity of all incidences
/// is summed: weights mu dOmega, sum pi.
[[nodiscard]] std::vector<HemisphereNode> incidence_nodes(bool is_isotropic, NodeLevel level);

/// The light on the surface as directions with their irradiance: a beam is one, a disk 32, a sky rings. With
/// `only_zenith_angle` those of a ring are one at phi = 0. Errors: InvalidInput where a radiance is negative or not
/// finite, or no light falls on the surface.
[[nodiscard]] Result<std::vector<HemisphereNode>> light_nodes(const Light& light, bool only_zenith_angle,
                                                              NodeLevel level);

}  // namespace gonio::reflectance
