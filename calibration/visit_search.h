#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/clock.h"

namespace gonio::calibration {

/// Of visits in time order (`at`), the number of the first that is not before `when`; their number: none. Visits come
/// at about even distances: the search begins where an even course would have it and widens from there, so that it
/// takes two or three looks where halving takes ten. Threads: any.
template <class Visit>
[[nodiscard]] std::size_t first_not_before(const std::vector<Visit>& visits, Instant when) {
  const std::size_t n = visits.size();
  if (n == 0 || !(visits.front().at < when)) return 0;
  if (visits.back().at < when) return n;
  // From here on visits[0] lies before `when`, visits[n - 1] does not.
  const double course = in_seconds(when - visits.front().at) / in_seconds(visits.back().at - visits.front().at);
  const auto guess = std::clamp<std::size_t>(static_cast<std::size_t>(course * static_cast<double>(n - 1)), 0, n - 2);
  std::size_t low = guess;
  std::size_t high = guess + 1;
  for (std::size_t step = 1; !(visits[low].at < when); step *= 2) {
    high = low;
    low -= std::min(low, step);
  }
  for (std::size_t step = 1; visits[high].at < when; step *= 2) {
    low = high;
    high = std::min(n - 1, high + step);
  }
  const auto from = visits.begin();
  const auto found = std::ranges::lower_bound(from + static_cast<std::ptrdiff_t>(low) + 1,
                                              from + static_cast<std::ptrdiff_t>(high), when, {}, &Visit::at);
  return static_cast<std::size_t>(found - from);
}

}  // namespace gonio::calibration
