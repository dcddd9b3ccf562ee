#pragma once

#include <functional>
#include <vector>

namespace gonio::bench {

/// How long one call takes [s], wall clock of the calling thread.
[[nodiscard]] double seconds_of(const std::function<void()>& run);

/// What is to be timed: `rough_s` says what one call takes, to within a factor.
struct Timed {
  std::function<void()> run;
  double rough_s = 0.0;
};

/// The median [s] of one call of each. All are timed in turns, round after round, so that whatever slows the machine
/// for a while slows them alike; short calls are repeated to fill a tenth of a millisecond.
[[nodiscard]] std::vector<double> interleaved_medians(const std::vector<Timed>& all, int rounds);

/// Median of values; they may be in any order. At least one (asserted).
[[nodiscard]] double median(std::vector<double> values);

}  // namespace gonio::bench
