#include "bench/order/lower_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace gonio::bench {

namespace {

using stage::Axis;

constexpr std::array<Axis, 4> kArms{Axis::ThetaI, Axis::ThetaR, Axis::PhiR, Axis::PhiI};
using Stand = std::array<double, 4>;  // of kArms, in degrees

double within_half_a_turn(double phi) {
  while (phi > 180.0) phi -= 360.0;
  while (phi <= -180.0) phi += 360.0;
  return phi;
}

class Stage {
 public:
  explicit Stage(const drivers::StageConfig& config) : config_(config) {}

  [[nodiscard]] double axis_s(std::size_t a, double way) const {
    const auto& axis = config_.axis(kArms[a]);
    if (way == 0.0) return 0.0;
    const double peak = std::sqrt(way * axis.acceleration);
    return peak <= axis.speed ? 2.0 * peak / axis.acceleration : way / axis.speed + axis.speed / axis.acceleration;
  }

  // Azimuths may be reached a whole turn away: the shorter way counts, which no walk can beat.
  [[nodiscard]] double step_s(const Stand& from, const Stand& to) const {
    double move_s = 0.0;
    double settle_s = 0.0;
    for (std::size_t a = 0; a < kArms.size(); ++a) {
      double way = std::abs(to[a] - from[a]);
      if (a >= 2 && may_turn_over(a)) way = std::min(way, std::abs(360.0 - way));
      if (way < 1e-9) continue;
      move_s = std::max(move_s, axis_s(a, way));
      settle_s = std::max(settle_s, in_seconds(config_.axis(kArms[a]).settle));
    }
    return move_s + settle_s;
  }

 private:
  [[nodiscard]] bool may_turn_over(std::size_t a) const {
    const auto& axis = config_.axis(kArms[a]);
    return axis.high - axis.low > 360.0;
  }
  const drivers::StageConfig& config_;
};

std::vector<Stand> stands_of(std::span<const Geometry> directions) {
  std::vector<Stand> stands;
  for (const Geometry& g : directions) {
    stands.push_back({in_degrees(g.theta_i), in_degrees(g.theta_r), within_half_a_turn(in_degrees(g.phi_r)),
                      within_half_a_turn(in_degrees(g.phi_i))});
    for (double& x : stands.back()) x = std::round(x * 1e9) / 1e9;
  }
  std::ranges::sort(stands);
  stands.erase(std::unique(stands.begin(), stands.end()), stands.end());
  return stands;
}

// Nodes: the places, then home, then an end that is reached from every place for nothing.
class Path {
 public:
  Path(const Stage& stage, const std::vector<Stand>& stands) : places_(stands.size()), n_(stands.size() + 2) {
    constexpr float kNever = 1e9F;
    cost_.assign(n_ * n_, kNever);
    for (std::size_t i = 0; i < places_; ++i) {
      for (std::size_t j = 0; j < i; ++j) link(i, j, stage.step_s(stands[i], stands[j]));
      link(i, places_, stage.step_s({}, stands[i]));
      link(i, places_ + 1, 0.0);
    }
  }

  // A walk is a spanning tree with two links at each place and one at home and at the end; so for any multipliers the
  // cheapest tree, less what they add to a walk, is below every walk.
  double raise(int rounds, double guess_s) {
    std::vector<double> multiplier(n_, 0.0);
    double best = -std::numeric_limits<double>::infinity();
    double stride = 2.0;
    int since_better = 0;
    for (int round = 0; round < rounds && stride > 1e-3; ++round) {
      const double bound = tree(multiplier);
      if (bound > best + 1e-6 * std::abs(best)) since_better = 0;
      best = std::max(best, bound);
      if (++since_better > 20) {
        stride *= 0.7;
        since_better = 0;
      }
      double norm = 0.0;
      for (std::size_t i = 0; i < n_; ++i) norm += excess(i) * excess(i);
      if (norm == 0.0) break;
      const double step = stride * std::max(1.02 * guess_s - bound, 1e-3 * guess_s) / norm;
      for (std::size_t i = 0; i < n_; ++i) multiplier[i] += step * excess(i);
    }
    return best;
  }

 private:
  void link(std::size_t i, std::size_t j, double cost) {
    // Rounded down: the bound must stay below.
    const float down = std::nextafter(static_cast<float>(cost), 0.0F);
    cost_[i * n_ + j] = cost_[j * n_ + i] = down;
  }
  [[nodiscard]] double wanted(std::size_t i) const { return i < places_ ? 2.0 : 1.0; }
  [[nodiscard]] double excess(std::size_t i) const { return degree_[i] - wanted(i); }

  double tree(const std::vector<double>& multiplier) {  // Prim (1957), dense
    std::vector<double> near(n_, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> by(n_, n_ - 1);
    std::vector<std::size_t> left(n_ - 1);
    std::iota(left.begin(), left.end(), 0);
    degree_.assign(n_, 0.0);
    double sum = 0.0;
    std::size_t last = n_ - 1;
    while (!left.empty()) {
      std::size_t next = 0;
      const float* row = &cost_[last * n_];
      for (std::size_t k = 0; k < left.size(); ++k) {
        const std::size_t i = left[k];
        const double c = static_cast<double>(row[i]) + multiplier[i] + multiplier[last];
        if (c < near[i]) {
          near[i] = c;
          by[i] = last;
        }
        if (near[i] < near[left[next]]) next = k;
      }
      last = left[next];
      left[next] = left.back();
      left.pop_back();
      sum += near[last];
      degree_[last] += 1.0;
      degree_[by[last]] += 1.0;
    }
    for (std::size_t i = 0; i < n_; ++i) sum -= multiplier[i] * wanted(i);
    return sum;
  }

  std::size_t places_;
  std::size_t n_;
  std::vector<float> cost_;
  std::vector<double> degree_;
};

// Each place but the last has two steps, the last one; home has one of its own.
double two_cheapest(const Stage& stage, std::vector<Stand> stands) {
  stands.push_back({});
  std::size_t widest = 0;
  double width_s = 0.0;
  for (std::size_t a = 0; a < 2; ++a) {  // the arms' own angles: no whole turns to think of
    const auto [low, high] = std::ranges::minmax(stands, {}, [a](const Stand& s) { return s[a]; });
    if (stage.axis_s(a, high[a] - low[a]) <= width_s) continue;
    width_s = stage.axis_s(a, high[a] - low[a]);
    widest = a;
  }
  std::ranges::sort(stands, {}, [widest](const Stand& s) { return s[widest]; });
  double sum = 0.0;
  double largest_second = 0.0;
  for (std::size_t i = 0; i < stands.size(); ++i) {
    double first = std::numeric_limits<double>::infinity();
    double second = first;
    const auto look = [&](std::size_t j) {
      if (stage.axis_s(widest, std::abs(stands[j][widest] - stands[i][widest])) > second) return false;
      const double c = stage.step_s(stands[i], stands[j]);
      second = std::min(second, std::max(c, first));
      first = std::min(first, c);
      return true;
    };
    for (std::size_t j = i + 1; j < stands.size() && look(j); ++j) {
    }
    for (std::size_t j = i; j-- > 0 && look(j);) {
    }
    const bool is_home = stands[i] == Stand{};
    sum += first + (is_home ? 0.0 : second);
    largest_second = std::max(largest_second, second);
  }
  return 0.5 * (sum - largest_second);
}

}  // namespace

WalkBound lower_bound(const drivers::StageConfig& stage, std::span<const Geometry> directions) {
  const std::vector<Stand> stands = stands_of(directions);
  const Stage axes(stage);
  const double rough_s = two_cheapest(axes, stands);
  if (stands.size() > kMostExact) return {.time_s = rough_s, .places = stands.size()};
  constexpr int kRounds = 1500;
  const double held_karp_s = Path(axes, stands).raise(kRounds, 1.3 * rough_s);
  return {.time_s = std::max(rough_s, held_karp_s), .places = stands.size(), .is_held_karp = true};
}

}  // namespace gonio::bench
