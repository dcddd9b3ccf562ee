#include "daemon/planner/measuring_order.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "daemon/planner/estimate.h"

namespace gonio::daemon {

namespace {

using stage::Axis;
using Nesting = std::array<std::size_t, kPlanListCount>;  // lists, slowest first

// The positions that a list asks of its axis, in the order of the list.
std::vector<double> positions_of(const api::Plan& plan, const Instrument& instrument, std::size_t list) {
  std::vector<double> positions;
  const auto add_angles = [&positions](const std::vector<Angle>& angles) {
    for (const Angle a : angles) positions.push_back(in_degrees(a));
  };
  if (list == 0) add_angles(plan.theta_i);
  if (list == 1) add_angles(plan.phi_i);
  if (list == 2) add_angles(plan.theta_r);
  if (list == 3) add_angles(plan.phi_r);
  if (list == 4) {
    for (const Wavelength w : plan.wavelengths) {
      const Filter* filter = filter_for(instrument, w);
      positions.push_back(filter == nullptr ? 0.0 : static_cast<double>(filter->slot));
    }
  }
  return positions;
}

constexpr std::array<Axis, kPlanListCount> kAxisOfList{Axis::ThetaI, Axis::PhiI, Axis::ThetaR, Axis::PhiR,
                                                       Axis::FilterWheel};

// The mean time of one step along a list, from a value to the next.
double mean_step_s(const api::Plan& plan, const Instrument& instrument, std::size_t list) {
  const std::vector<double> positions = positions_of(plan, instrument, list);
  if (positions.size() < 2) return 0.0;
  const auto& axis = instrument.stage.axis(kAxisOfList[list]);
  double sum = 0.0;
  for (std::size_t k = 1; k < positions.size(); ++k) {
    sum += in_seconds(travel_time(axis, positions[k] - positions[k - 1]) + axis.settle);
  }
  return sum / static_cast<double>(positions.size() - 1);
}

// Walked to and fro, each step of the whole walk moves along one list only: prod(n of the slower lists) * (n - 1) steps
// each.
double walk_time_s(const Nesting& nesting, const GridPlace& sizes, const std::array<double, kPlanListCount>& step_s) {
  double passes = 1.0;
  double total = 0.0;
  for (const std::size_t list : nesting) {
    total += passes * (sizes[list] - 1.0) * step_s[list];
    passes *= sizes[list];
  }
  return total;
}

Nesting cheapest_nesting(const api::Plan& plan, const Instrument& instrument, const GridPlace& sizes) {
  std::array<double, kPlanListCount> step_s{};
  for (std::size_t list = 0; list < kPlanListCount; ++list) step_s[list] = mean_step_s(plan, instrument, list);
  Nesting nesting{0, 1, 2, 3, 4};
  Nesting best = nesting;
  double best_s = std::numeric_limits<double>::infinity();
  do {
    const double t = walk_time_s(nesting, sizes, step_s);
    if (t < best_s) {
      best_s = t;
      best = nesting;
    }
  } while (std::next_permutation(nesting.begin(), nesting.end()));
  return best;
}

// The step of the to-and-fro walk at which a place is passed.
std::uint64_t step_of(const GridPlace& place, const GridPlace& sizes, const Nesting& nesting) {
  std::uint64_t step = 0;
  for (const std::size_t list : nesting) {
    const bool backwards = step % 2 == 1;
    const std::uint64_t along = backwards ? sizes[list] - 1 - place[list] : place[list];
    step = step * sizes[list] + along;
  }
  return step;
}

// SplitMix64 (Steele, Lea, Flood 2014): the same on every platform, unlike std::shuffle.
std::uint64_t next_random(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = state;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

void shuffle(std::vector<std::int32_t>& order, std::uint64_t seed) {
  for (std::size_t k = order.size(); k > 1; --k) {
    // The bias of the remainder is below 2^-40 for the 10^7 points that a plan may have.
    std::swap(order[k - 1], order[static_cast<std::size_t>(next_random(seed) % k)]);
  }
}

}  // namespace

std::vector<std::int32_t> measuring_order(const api::Plan& plan, const Instrument& instrument,
                                          const std::vector<ScanPoint>& points, const std::vector<GridPlace>& places,
                                          const GridPlace& sizes) {
  std::vector<std::int32_t> order;
  for (const ScanPoint& point : points) {
    if (!point.blocked) order.push_back(point.index);
  }
  if (plan.order == api::OrderStrategy::Random) shuffle(order, plan.order_seed);
  if (plan.order != api::OrderStrategy::Fastest) return order;

  const Nesting nesting = cheapest_nesting(plan, instrument, sizes);
  std::vector<std::uint64_t> steps(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) steps[k] = step_of(places[k], sizes, nesting);
  std::sort(order.begin(), order.end(), [&steps](std::int32_t a, std::int32_t b) {
    return steps[static_cast<std::size_t>(a)] < steps[static_cast<std::size_t>(b)];
  });
  return order;
}

}  // namespace gonio::daemon
