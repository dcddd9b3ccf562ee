#pragma once

#include <functional>
#include <vector>

namespace gonio::bench {

/// How long one call keeps the processor [s]: time that other programs take from this thread does not count.
[[nodiscard]] double seconds_of(const std::function<void()>& run);

/// What is to be timed, as often in one call as it is told: `rough_s` is what the first call took.
struct Timed {
  std::function<void(long repeats)> run;
  double rough_s = 0.0;
};

/// The median [s] of each, once. All are timed in turns, round after round, so that whatever slows the machine
/// for a while slows them alike; short ones are repeated to fill a third of a millisecond.
[[nodiscard]] std::vector<double> interleaved_medians(const std::vector<Timed>& all, int rounds);

/// Median of values; they may be in any order. At least one (asserted).
[[nodiscard]] double median(std::vector<double> values);

}  // namespace gonio::bench
