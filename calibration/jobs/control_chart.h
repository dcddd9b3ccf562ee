#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gonio::calibration {

/// One run of a check standard.
struct ChartRun {
  double value = 0.0;
  double u_own = 0.0;  ///< standard uncertainty of what each run draws anew: what shared errors do to all alike
};

/// The four rules of the Western Electric handbook (1956), each looking back from a run.
enum class ChartRule : std::uint8_t {
  BeyondThree = 1U << 0U,    ///< one run beyond three standard deviations
  TwoBeyondTwo = 1U << 1U,   ///< two of three beyond two, on one side
  FourBeyondOne = 1U << 2U,  ///< four of five beyond one, on one side
  EightOnOneSide = 1U << 3U,
};
/// "beyond 3 sd, eight on one side"; empty for none.
[[nodiscard]] std::string broken_rules_text(std::uint8_t rules);

struct JudgedRun {
  double deviation = 0.0;   ///< from the centre, in standard deviations of the chart
  std::uint8_t broken = 0;  ///< ChartRule bits
};

/// A Shewhart chart of single runs. Centre: the mean of the first ten runs (five at least); standard deviation: the
/// larger of their scatter and the root mean square of their own u. Runs of the baseline are judged too.
struct ControlChart {
  std::size_t baseline = 0;  ///< runs that centre and limits come from; 0: too few yet, and nothing is judged
  double centre = 0.0;
  double sd = 0.0;
  std::vector<JudgedRun> runs;
  [[nodiscard]] double low() const { return centre - 3.0 * sd; }
  [[nodiscard]] double high() const { return centre + 3.0 * sd; }
};
[[nodiscard]] ControlChart control_chart(std::span<const ChartRun> runs);

}  // namespace gonio::calibration
