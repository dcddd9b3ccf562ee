#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "reflectance/check/symmetry_point.h"

namespace gonio::reflectance {

/// Under what a BRDF is to stay the same.
enum class Symmetry : std::uint8_t {
  Reciprocity,  ///< i and r exchanged
  LeftRight,    ///< r mirrored at the plane of incidence: phi_r - phi_i changes sign
  Turn,         ///< i and r turned about the normal: an isotropic surface
};

/// When two geometries count as one, for the sample at hand.
enum class Sameness : std::uint8_t {
  Exact,             ///< both directions agree
  Turned,            ///< after a turn about the normal: the sample is taken for isotropic
  TurnedOrMirrored,  ///< or a mirror image as well: only the size of phi_r - phi_i counts
};

struct SymmetryOptions {
  Angle tolerance = degrees(0.05);  ///< of arc, for each direction; 0 to 5 deg
  Sameness sameness = Sameness::Exact;
};

/// Which points should agree. Each point stands in at most one group.
struct SymmetryGroups {
  std::vector<std::vector<std::size_t>> groups;  ///< indices, the first in the order of the points; at least two each
  std::size_t unpaired = 0;                      ///< no other point has the symmetric geometry
  std::size_t trivial = 0;                       ///< the symmetric geometry is the point's own: nothing to learn
  std::size_t repeated = 0;                      ///< the geometry of a member of a group again (Turn only)
};

/// Reciprocity and LeftRight make pairs: each point in turn with the nearest free one within the tolerance; of points
/// read twice the second finds the second partner or none. Turn makes groups of all that differ by a turn (`sameness`
/// is not asked; at theta_i = 0 or theta_r = 0 every azimuth is a turn of the others). Errors: InvalidInput, naming the
/// point: a theta beyond 90 deg either way, an angle that is not finite; or a tolerance out of range.
[[nodiscard]] Result<SymmetryGroups> find_symmetry_groups(Symmetry symmetry, std::span<const SymmetryPoint> points,
                                                          const SymmetryOptions& options);

}  // namespace gonio::reflectance
