#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gonio::bench {

/// One measured setting of a method on one case.
struct Step {
  std::string setting;
  std::uint64_t evaluations = 0;
  double error = 0.0;    ///< relative, against the reference value
  double seconds = 0.0;  ///< median
};

/// A method's settings from coarse to fine on one case.
using Ladder = std::vector<Step>;

/// The first step from which on no step errs by more than `error`: a coarse setting that is right by luck does not
/// count. Null when there is none.
[[nodiscard]] const Step* first_within(const Ladder& ladder, double error);

/// The time [s] to an error of `error`, between that step and the one before it by interpolation in the logarithms; NaN
/// when the ladder does not get there.
[[nodiscard]] double interpolated_seconds(const Ladder& ladder, double error);

}  // namespace gonio::bench
