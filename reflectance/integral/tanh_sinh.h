#pragma once

#include <vector>

namespace gonio::reflectance {

/// A node of a rule over [0, 1] that keeps its distance from both ends, each to full relative precision.
struct EndNode {
  double x = 0.0;
  double rest = 0.0;  ///< 1 - x
  double weight = 0.0;
};

/// The double-exponential rule of Takahasi and Mori (1974) with step 2^-level, level 0 to 8 (asserted): takes an
/// algebraic or logarithmic singularity at either end in its stride and squares its error from one level to the next.
/// Some 7 x 2^level nodes, made once a level and kept. Threads: any.
[[nodiscard]] const std::vector<EndNode>& tanh_sinh(int level);

}  // namespace gonio::reflectance
