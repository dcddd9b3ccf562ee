#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/result.h"
#include "reflectance/check/shared_effects.h"

namespace gonio::reflectance {

/// One value for a test of agreement.
struct GroupMember {
  double value = 0.0;
  double u_random = 0.0;  ///< above 0 (asserted)
  SharedEffects shared;
};

struct GroupChiSquare {
  double chi2 = 0.0;
  std::size_t degrees_of_freedom = 0;  ///< members less groups
};

/// How well the members of each group agree with each other: the least sum of
///   (value - mean of its group - sum of c_k e_k)^2 / u_random^2  over all members  +  sum of e_k^2
/// over the means and the shared errors e_k, which is chi-square with the full covariance of what does not cancel
/// (Woodbury's identity). Errors: InvalidInput for more than 2048 components that do not cancel.
[[nodiscard]] Result<GroupChiSquare> group_chi_square(std::span<const std::vector<GroupMember>> groups);

}  // namespace gonio::reflectance
