#include "daemon/planner/order_report.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "daemon/planner/estimate.h"
#include "daemon/planner/measuring_order.h"
#include "daemon/planner/neighbours.h"
#include "daemon/planner/snake.h"

namespace gonio::daemon {

namespace {

// A walk from home is a spanning tree with one link at home, one at an end that is reached for nothing, and two at each
// place. So the cheapest tree, under any multipliers that are charged for links and paid back for the right number of
// them, is below every walk; subgradient steps raise it.
class TreeBound {
 public:
  TreeBound(std::span<const Place> places, const StepPrice& price) : n_(places.size() + 1), links_(n_) {
    constexpr double kNever_s = 1e9;
    cost_s_.assign(n_ * n_, kNever_s);
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double weight = j == 0 ? 0.5 : 1.0;
        cost_s_[i * n_ + j] = cost_s_[j * n_ + i] = weight * price.mean_s(places[i], places[j]);
      }
      if (i > 0) cost_s_[i * n_ + n_ - 1] = cost_s_[(n_ - 1) * n_ + i] = 0.0;
    }
  }

  double raise(double walk_s) {
    constexpr int kAscents = 200;
    std::vector<double> multiplier(n_, 0.0);
    double best_s = 0.0;
    double stride = 1.5;
    for (int round = 0; round < kAscents; ++round) {
      const double bound_s = tree(multiplier);
      best_s = std::max(best_s, bound_s);
      double excess = 0.0;
      for (std::size_t i = 0; i < n_; ++i) excess += (links_[i] - wanted(i)) * (links_[i] - wanted(i));
      if (excess == 0.0) break;
      const double step = stride * (walk_s - bound_s) / excess;
      for (std::size_t i = 0; i < n_; ++i) multiplier[i] += step * (links_[i] - wanted(i));
      stride *= 0.98;
    }
    return best_s;
  }

 private:
  [[nodiscard]] double wanted(std::size_t i) const { return i == 0 || i + 1 == n_ ? 1.0 : 2.0; }

  double tree(const std::vector<double>& multiplier) {  // Prim (1957)
    std::vector<double> near_s(n_, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> from(n_, 0);
    std::vector<bool> is_in(n_, false);
    std::ranges::fill(links_, 0.0);
    double sum_s = 0.0;
    std::size_t last = 0;
    for (std::size_t count = 1; count < n_; ++count) {
      is_in[last] = true;
      std::size_t next = n_;
      for (std::size_t i = 0; i < n_; ++i) {
        if (is_in[i]) continue;
        const double c = cost_s_[last * n_ + i] + multiplier[last] + multiplier[i];
        if (c < near_s[i]) {
          near_s[i] = c;
          from[i] = last;
        }
        if (next == n_ || near_s[i] < near_s[next]) next = i;
      }
      last = next;
      sum_s += near_s[last];
      links_[last] += 1.0;
      links_[from[last]] += 1.0;
    }
    for (std::size_t i = 0; i < n_; ++i) sum_s -= multiplier[i] * wanted(i);
    return sum_s;
  }

  std::size_t n_;
  std::vector<double> cost_s_;
  std::vector<double> links_;  ///< at each node of the last tree
};

// Each place has two steps but the last, which has one.
double two_cheapest_s(std::span<const Place> places, const StepPrice& price) {
  if (places.size() < 3) return 0.0;
  const Neighbours neighbours(places, price, 2);
  double sum_s = 0.0;
  double dearest_s = 0.0;
  for (std::size_t k = 1; k < places.size(); ++k) {
    const auto two = neighbours.of(static_cast<std::int32_t>(k));
    const auto weighed = [&two](std::size_t n) { return (two[n].place == 0 ? 0.5 : 1.0) * two[n].price_s; };
    sum_s += weighed(0) + weighed(1);
    dearest_s = std::max(dearest_s, std::max(weighed(0), weighed(1)));
  }
  return 0.5 * (sum_s - dearest_s);
}

Duration whole_scan(const api::Plan& plan, const Instrument& instrument, const PlannedScan& planned,
                    std::span<const std::int32_t> order) {
  const auto time = estimate(plan, instrument, planned.points, order, planned.experience);
  return time ? time->total() : Duration::zero();
}

}  // namespace

OrderReport judge_order(const api::Plan& plan, const Instrument& instrument, const PlannedScan& planned) {
  OrderReport report;
  std::vector<Place> places = places_along(instrument, planned.points, planned.order);
  const StepPrice price(instrument, places);
  std::vector<std::int32_t> walk(places.size() - 1);
  std::iota(walk.begin(), walk.end(), 1);
  const double walked_s = walk_s(places, walk, price);
  places.erase(std::unique(places.begin(), places.end()), places.end());  // repeats follow each other
  double bound_s = two_cheapest_s(places, price);
  report.is_held_karp = places.size() <= kMostHeldKarp + 1;
  if (report.is_held_karp) bound_s = std::max(bound_s, TreeBound(places, price).raise(walked_s));
  report.walk = seconds(walked_s);
  report.bound = seconds(std::min(bound_s, walked_s));
  std::vector<std::int32_t> written = planned.order;
  std::ranges::sort(written);
  report.as_written = whole_scan(plan, instrument, planned, written);
  report.snaked = whole_scan(plan, instrument, planned, snaked_order(instrument, planned.points));
  return report;
}

}  // namespace gonio::daemon
