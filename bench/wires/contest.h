#pragma once

#include <functional>
#include <string>

namespace gonio::bench {

/// What our link must reach of a bare loop over the library below it, of the same exchange.
inline constexpr double kLeastRatio = 0.9;

/// One stretch of exchanges: how many a second, or 0 when one failed.
using Stretch = std::function<double()>;

/// Two ways of the same exchange against the same device.
struct Contest {
  std::string what;  ///< "stage, Modbus TCP: FC23 of 1 and 96 registers"
  Stretch ours;
  Stretch bare;
};

/// Runs `exchanges` calls after two that do not count, on a thread of its own, and times them; 0 when one returns
/// false.
[[nodiscard]] double per_second(int exchanges, const std::function<bool()>& exchange);

/// Takes the two in turns, `rounds` times, each round beginning with the other one; prints medians, and the median and
/// spread (quartiles) of the rounds' ratios. True when the median ratio holds. A machine that slows down slows both.
[[nodiscard]] bool hold(const Contest& contest, int rounds);
void print_heading();

}  // namespace gonio::bench
