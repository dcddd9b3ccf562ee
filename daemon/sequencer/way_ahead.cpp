#include "daemon/sequencer/way_ahead.h"

#include <algorithm>

#include "daemon/planner/estimate.h"
#include "daemon/planner/planner.h"

namespace gonio::daemon {

namespace {

double step_between(const Instrument& instrument, const std::vector<ScanPoint>& points, std::int32_t from,
                    std::int32_t to) {
  stage::PerAxis<double> standing = home_position(instrument);
  StepTime step;
  for (const std::int32_t index : {from, to}) {
    const ScanPoint& point = points[static_cast<std::size_t>(index)];
    const auto target = axis_targets(point.geometry, point.wavelength, instrument, standing);
    if (!target) return 0.0;
    step = step_time(instrument, standing, *target).value_or(StepTime{});
    for (std::size_t a = 0; a < standing.size(); ++a) standing[a] = (*target)[a].value_or(standing[a]);
  }
  return in_seconds(step.move + step.settle);
}

}  // namespace

void WayAhead::look_on(const Instrument& instrument, const std::vector<ScanPoint>& points,
                       const std::vector<std::int32_t>& order, int steps) {
  const std::size_t end = std::min(order.size(), until_s_.size() + static_cast<std::size_t>(steps));
  if (until_s_.empty()) {
    standing_ = home_position(instrument);
    until_s_.reserve(order.size());
  }
  for (std::size_t place = until_s_.size(); place < end; ++place) {
    const ScanPoint& point = points[static_cast<std::size_t>(order[place])];
    const auto target = axis_targets(point.geometry, point.wavelength, instrument, standing_);
    double step_s = 0.0;
    if (target && place > 0) {
      const StepTime step = step_time(instrument, standing_, *target).value_or(StepTime{});
      step_s = in_seconds(step.move + step.settle);
    }
    for (std::size_t a = 0; target && a < standing_.size(); ++a) standing_[a] = (*target)[a].value_or(standing_[a]);
    until_s_.push_back((until_s_.empty() ? 0.0 : until_s_.back()) + step_s);
  }
}

WayAhead::Length WayAhead::between(std::size_t from, std::size_t to) const {
  if (until_s_.empty() || to <= from) return {};
  const std::size_t last = until_s_.size() - 1;
  const double mean_s = last == 0 ? 0.0 : until_s_[last] / static_cast<double>(last);
  const double seen_s = until_s_[std::min(to, last)] - until_s_[std::min(from, last)];
  const double unseen_s = to > last ? mean_s * static_cast<double>(to - std::max(from, last)) : 0.0;
  return {seen_s + unseen_s, unseen_s};
}

// The first place whose item begins after the pass.
std::size_t WayAhead::end_of_block(std::size_t begin, std::size_t size, const Blocks& blocks) const {
  std::size_t low = begin + 1;
  std::size_t high = size;
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    const double took_s = between(begin, middle).time_s + blocks.work_s * static_cast<double>(middle - begin);
    took_s >= blocks.pass_s ? high = middle : low = middle + 1;
  }
  return low;
}

WayAhead::Turns WayAhead::turns(const Instrument& instrument, const std::vector<ScanPoint>& points,
                                const std::vector<std::int32_t>& order, const Blocks& blocks) const {
  constexpr int kPlayed = 32;     // those after them are like these
  constexpr double kMoved = 0.1;  // a block that ends elsewhere has another way back: relative
  double back_s = 0.0;
  double played = 0.0;
  std::size_t begin = std::min(blocks.begun, order.size());
  for (std::size_t end = begin; played < kPlayed && begin < order.size(); begin = end, ++played) {
    end = end_of_block(begin, order.size(), blocks);
    if (end >= order.size()) break;
    const auto leap = step_between(instrument, points, order[begin], order[end]);
    back_s += std::max(blocks.to_reference_s, leap);
  }
  const auto passed = static_cast<double>(begin - blocks.begun);
  const bool all_played = played < kPlayed;
  const double more = all_played || passed == 0.0 ? 1.0 : static_cast<double>(order.size() - blocks.begun) / passed;
  const double there = more * played + (all_played ? 1.0 : 0.0) - (blocks.is_on_reference ? 1.0 : 0.0);
  return {more * back_s + std::max(there, 0.0) * blocks.to_reference_s,
          kMoved * more * back_s + blocks.to_reference_s / 2.0};
}

}  // namespace gonio::daemon
