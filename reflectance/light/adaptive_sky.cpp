#include "reflectance/light/adaptive_sky.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <queue>
#include <vector>

#include "reflectance/integral/compensated_sum.h"
#include "reflectance/integral/gauss_legendre.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kMostEvaluations = 4'000'000;
constexpr int kHalvingsAtHard = 10;

// Between two values of s = sqrt(elevation), which takes up the powers of mu at the horizon and is even at the zenith,
// and two azimuths.
struct Cell {
  double s_low;
  double s_high;
  double phi_low;
  double phi_high;
  double value = 0.0;
  double size = 0.0;
  double error = 0.0;
  friend bool operator<(const Cell& a, const Cell& b) { return a.error < b.error; }
};

class CellRule {
 public:
  explicit CellRule(const std::function<double(const Direction&)>& h) : h_(h) {}

  void evaluate(Cell& cell) {
    const double coarse = product(cell, coarse_);
    cell.value = product(cell, fine_);
    cell.error = std::abs(cell.value - coarse);
    cell.size = size_;
  }
  [[nodiscard]] std::uint64_t evaluations() const { return evaluations_; }

 private:
  double product(const Cell& cell, const UnitRule& rule) {
    double sum = 0.0;
    size_ = 0.0;
    const double ds = cell.s_high - cell.s_low;
    const double dphi = cell.phi_high - cell.phi_low;
    for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
      const double s = cell.s_low + ds * rule.nodes[j];
      const double elevation = std::min(s * s, 0.5 * kPi);
      for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const Angle phi = radians(cell.phi_low + dphi * rule.nodes[k]);
        const Direction i = Direction::from_elevation(radians(elevation), phi);
        const double weight = 2.0 * s * ds * dphi * rule.weights[j] * rule.weights[k];
        const double term = weight * i.mu() * i.sin_theta() * h_(i);
        sum += term;
        size_ += std::abs(term);
        ++evaluations_;
      }
    }
    return sum;
  }

  const std::function<double(const Direction&)>& h_;
  UnitRule coarse_ = gauss_legendre(3);
  UnitRule fine_ = gauss_legendre(5);
  double size_ = 0.0;
  std::uint64_t evaluations_ = 0;
};

void sort_apart(std::vector<double>& cuts) {
  std::ranges::sort(cuts);
  // Not ranges::unique: its subrange does not build with clang 14.
  const auto doubled = std::unique(cuts.begin(), cuts.end(), [](double a, double b) { return b - a < 1e-13; });
  cuts.erase(doubled, cuts.end());
}

std::vector<Cell> first_cells(const Sky& sky, const std::optional<Direction>& hard) {
  const auto root = [](double elevation) { return std::sqrt(std::max(0.0, elevation)); };
  std::vector<double> s{0.0, root(0.5 * kPi)};
  for (const Angle theta : sky.theta_breaks()) s.push_back(root(0.5 * kPi - theta.si()));
  if (hard) s.push_back(root(hard->elevation().si()));
  sort_apart(s);

  std::vector<double> phi;
  for (const Angle b : sky.phi_breaks()) phi.push_back(wrapped(b).si());
  if (hard) phi.push_back(hard->phi().si());
  for (int quarter = -2; quarter < 2; ++quarter) phi.push_back(0.5 * kPi * quarter);
  phi.push_back(kPi);
  sort_apart(phi);

  std::vector<Cell> cells;
  for (std::size_t j = 0; j + 1 < s.size(); ++j) {
    for (std::size_t k = 0; k + 1 < phi.size(); ++k) {
      cells.push_back({.s_low = s[j], .s_high = s[j + 1], .phi_low = phi[k], .phi_high = phi[k + 1]});
    }
  }
  return cells;
}

template <class Take>
void halve(const Cell& c, Take take) {
  const double s = 0.5 * (c.s_low + c.s_high);
  const double phi = 0.5 * (c.phi_low + c.phi_high);
  take(Cell{.s_low = c.s_low, .s_high = s, .phi_low = c.phi_low, .phi_high = phi});
  take(Cell{.s_low = c.s_low, .s_high = s, .phi_low = phi, .phi_high = c.phi_high});
  take(Cell{.s_low = s, .s_high = c.s_high, .phi_low = c.phi_low, .phi_high = phi});
  take(Cell{.s_low = s, .s_high = c.s_high, .phi_low = phi, .phi_high = c.phi_high});
}

// Towards the pole, whose azimuths are one direction, only s is halved.
template <class Take>
void halve_towards(const Direction& hard, const Cell& c, Take take) {
  if (hard.sin_theta() > 0.0) return halve(c, take);
  const double s = 0.5 * (c.s_low + c.s_high);
  take(Cell{.s_low = c.s_low, .s_high = s, .phi_low = c.phi_low, .phi_high = c.phi_high});
  take(Cell{.s_low = s, .s_high = c.s_high, .phi_low = c.phi_low, .phi_high = c.phi_high});
}

bool touches(const Cell& c, const Direction& d) {
  constexpr double kRounding = 1e-12;
  const double s = std::sqrt(d.elevation().si());
  const bool in_phi = d.sin_theta() == 0.0 ||
                      std::abs(std::remainder(c.phi_low - d.phi().si(), 2.0 * kPi)) < kRounding ||
                      std::abs(std::remainder(c.phi_high - d.phi().si(), 2.0 * kPi)) < kRounding;
  return in_phi && s > c.s_low - kRounding && s < c.s_high + kRounding;
}

// Cells at the hard point, halved towards it again and again.
std::vector<Cell> graded(std::vector<Cell> cells, const std::optional<Direction>& hard) {
  if (!hard) return cells;
  for (int k = 0; k < kHalvingsAtHard; ++k) {
    std::vector<Cell> finer;
    for (const Cell& cell : cells) {
      if (touches(cell, *hard))
        halve_towards(*hard, cell, [&](const Cell& part) { finer.push_back(part); });
      else
        finer.push_back(cell);
    }
    cells = std::move(finer);
  }
  return cells;
}

}  // namespace

Integral integrate_cells(const Sky& sky, const std::optional<Direction>& hard,
                         const std::function<double(const Direction&)>& h, double relative_tolerance) {
  constexpr double kRounding = 1e-15;
  CellRule rule(h);
  std::priority_queue<Cell> cells;
  double error = 0.0;
  double size = 0.0;
  const auto take = [&](Cell cell) {
    rule.evaluate(cell);
    error += cell.error;
    size += cell.size;
    cells.push(cell);
  };
  for (const Cell& cell : graded(first_cells(sky, hard), hard)) take(cell);
  while (error > relative_tolerance * size && rule.evaluations() < kMostEvaluations) {
    const Cell worst = cells.top();
    cells.pop();
    error -= worst.error;
    size -= worst.size;
    halve(worst, take);
  }
  CompensatedSum value;
  CompensatedSum missed;
  for (; !cells.empty(); cells.pop()) {
    value.add(cells.top().value);
    missed.add(cells.top().error);
  }
  return {.value = value.value(), .error = missed.value() + kRounding * size, .evaluations = rule.evaluations()};
}

}  // namespace gonio::reflectance
