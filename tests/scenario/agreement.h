#pragma once

#include <functional>
#include <map>
#include <string>

#include "tests/scenario/store_copy.h"

namespace gonio::test {

struct ChiSquare {
  double value = 0.0;
  long degrees_of_freedom = 0;
  double p = 0.0;  ///< the probability of a larger value when the stated uncertainties are true
};

/// The probability that a chi-square of `degrees_of_freedom` is larger than `value` (NIST DLMF 8.2.4, 8.7.1, 8.9.2).
[[nodiscard]] double chi_square_tail(double value, long degrees_of_freedom);

/// Whether two measurements of the same points agree within what does not cancel between them: r^T C^-1 r of the
/// differences r of points that both have, C = the random parts of both and, of the shared components, those that
/// `is_drawn_anew` names as different in each run, with the correlations that they make between points.
[[nodiscard]] ChiSquare agreement(const std::map<long, StoredValue>& a, const std::map<long, StoredValue>& b,
                                  const std::function<bool(const std::string&)>& is_drawn_anew);

}  // namespace gonio::test
