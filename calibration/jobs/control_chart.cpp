#include "calibration/jobs/control_chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace gonio::calibration {

namespace {

constexpr std::size_t kBaseline = 10;
constexpr std::size_t kLeastBaseline = 5;

constexpr std::array<std::pair<ChartRule, const char*>, 4> kRuleNames{{
    {ChartRule::BeyondThree, "beyond 3 sd"},
    {ChartRule::TwoBeyondTwo, "two of three beyond 2 sd"},
    {ChartRule::FourBeyondOne, "four of five beyond 1 sd"},
    {ChartRule::EightOnOneSide, "eight on one side"},
}};

std::uint8_t bit(ChartRule rule) {
  return static_cast<std::uint8_t>(rule);
}

// Whether `wanted` of the last `of` runs up to `last` lie beyond `limit` on the side of the last one, itself among
// them.
bool are_beyond(const std::vector<JudgedRun>& runs, std::size_t last, std::size_t wanted, std::size_t of,
                double limit) {
  const double side = runs[last].deviation < 0.0 ? -1.0 : 1.0;
  if (side * runs[last].deviation <= limit || last + 1 < wanted) return false;
  const std::size_t first = last + 1 >= of ? last + 1 - of : 0;
  const auto count = std::count_if(runs.begin() + static_cast<std::ptrdiff_t>(first),
                                   runs.begin() + static_cast<std::ptrdiff_t>(last) + 1,
                                   [&](const JudgedRun& run) { return side * run.deviation > limit; });
  return static_cast<std::size_t>(count) >= wanted;
}

std::uint8_t rules_broken(const std::vector<JudgedRun>& runs, std::size_t at) {
  std::uint8_t broken = 0;
  if (are_beyond(runs, at, 1, 1, 3.0)) broken |= bit(ChartRule::BeyondThree);
  if (are_beyond(runs, at, 2, 3, 2.0)) broken |= bit(ChartRule::TwoBeyondTwo);
  if (are_beyond(runs, at, 4, 5, 1.0)) broken |= bit(ChartRule::FourBeyondOne);
  if (are_beyond(runs, at, 8, 8, 0.0)) broken |= bit(ChartRule::EightOnOneSide);
  return broken;
}

}  // namespace

std::string broken_rules_text(std::uint8_t rules) {
  std::string text;
  for (const auto& [rule, name] : kRuleNames) {
    if ((rules & bit(rule)) != 0) text += (text.empty() ? "" : ", ") + std::string(name);
  }
  return text;
}

ControlChart control_chart(std::span<const ChartRun> runs) {
  ControlChart chart{.runs = std::vector<JudgedRun>(runs.size())};
  if (runs.size() < kLeastBaseline) return chart;
  chart.baseline = std::min(kBaseline, runs.size());
  const auto first = runs.first(chart.baseline);
  const auto n = static_cast<double>(chart.baseline);
  double own = 0.0;
  for (const ChartRun& run : first) {
    chart.centre += run.value / n;
    own += run.u_own * run.u_own / n;
  }
  double squares = 0.0;
  for (const ChartRun& run : first) squares += (run.value - chart.centre) * (run.value - chart.centre);
  chart.sd = std::sqrt(std::max(own, squares / (n - 1.0)));
  for (std::size_t k = 0; k < runs.size() && chart.sd > 0.0; ++k) {
    chart.runs[k].deviation = (runs[k].value - chart.centre) / chart.sd;
    chart.runs[k].broken = rules_broken(chart.runs, k);
  }
  return chart;
}

}  // namespace gonio::calibration
