#pragma once

#include <vector>

namespace gonio::reflectance {

/// Nodes and weights of a rule over [0, 1]: the integral of f is the sum of weights[k] f(nodes[k]).
struct UnitRule {
  std::vector<double> nodes;    ///< ascending
  std::vector<double> weights;  ///< sum to 1
};

/// Gauss-Legendre with `size` >= 1 (asserted) nodes, exact to polynomials of degree 2 size - 1, accurate to some
/// 1e-16. Made once a size and kept. Threads: any.
[[nodiscard]] const UnitRule& gauss_legendre(int size);

}  // namespace gonio::reflectance
