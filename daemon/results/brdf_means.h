#pragma once

#include <cstddef>
#include <vector>

#include "daemon/store/records.h"

namespace gonio::daemon {

/// Means of REFF = pi f over groups of a scan's points, with their covariance: what the points share counts for all of
/// a mean and for both of two, the random part of a point for itself.
struct BrdfMeans {
  std::vector<double> values;      ///< one a group
  std::vector<double> covariance;  ///< row by row
  std::vector<double> u_own;       ///< of each mean: what this scan alone has drawn (is_drawn_anew, random parts)
};
/// `groups`: places in brdf.rows, each group with one at least.
[[nodiscard]] BrdfMeans means_of(const NewBrdf& brdf, const std::vector<std::vector<std::size_t>>& groups);

}  // namespace gonio::daemon
