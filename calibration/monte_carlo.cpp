#include "calibration/monte_carlo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/split_mix.h"

namespace gonio::calibration {
namespace {

/// A stream of normal and even numbers (Box and Muller 1958).
class Draws {
 public:
  explicit Draws(std::uint64_t stream) : stream_(stream) {}

  double even() {                                          // in (0, 1)
    constexpr double kPerStep = 1.0 / 9007199254740992.0;  // 2^-53
    return (static_cast<double>(stream_.next() >> 11U) + 0.5) * kPerStep;
  }
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(even()));
    const double turn = 2.0 * std::numbers::pi * even();
    spare_ = radius * std::sin(turn);
    has_spare_ = true;
    return radius * std::cos(turn);
  }

 private:
  SplitMix stream_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// The law's parts, as they are drawn.
struct Law {
  double u_divisor = 0.0;
  double x_per_divisor = 0.0;  ///< of X for one standard deviation of D
  double u_rest = 0.0;         ///< of X otherwise, without angles and what has bounds
  std::array<double, kDirectionAxes> slope{};
  std::array<double, kDirectionAxes> bend{};  ///< half the second derivative
  std::array<double, kDirectionAxes> u_angle{};
  std::vector<double> rectangles;                 ///< half widths
  std::array<double, kUnknownAngles> arcsine2{};  ///< u^2, of each angle
};

Law law_of(double value, const Budget& budget, const TermList& terms, const Nonlinearity& bent) {
  const std::vector<Component>& components = terms.components();
  std::vector<TermList::DivisorTerm> divisor = terms.divisor();
  std::ranges::stable_sort(divisor, {}, &TermList::DivisorTerm::component);
  const auto divided = [&](std::uint32_t component) {
    double sum = 0.0;
    auto term = std::ranges::lower_bound(divisor, component, {}, &TermList::DivisorTerm::component);
    for (; term != divisor.end() && term->component == component; ++term) sum += term->relative;
    return sum;
  };
  Law law;
  double x2 = 0.0;
  double d2 = 0.0;
  double xd = 0.0;
  for (const auto* list : {&budget.random, &budget.shared}) {
    for (const BudgetTerm& term : *list) {
      const double d = divided(term.component);
      // Random terms have lost their sign; those of a divisor are -value d and nothing else.
      const double x = list == &budget.random && d != 0.0 ? 0.0 : term.per_sd.si() + value * d;
      if (components[term.component].distribution == Distribution::Rectangular && d == 0.0) {
        law.rectangles.push_back(std::numbers::sqrt3 * x);
        continue;
      }
      if (components[term.component].distribution == Distribution::Arcsine && d == 0.0) {
        law.arcsine2[components[term.component].unknown_angle] += x * x;
        continue;
      }
      x2 += x * x;
      d2 += d * d;
      xd += x * d;
    }
  }
  for (std::size_t a = 0; a < kDirectionAxes; ++a) {
    law.slope[a] = bent.slope[a];
    law.bend[a] = 0.5 * bent.curvature[a];
    law.u_angle[a] = law.bend[a] == 0.0 ? 0.0 : bent.u_angle[a];  // without a bend its term is in X as it is
    x2 -= std::pow(law.slope[a] * law.u_angle[a], 2);
  }
  law.u_divisor = std::sqrt(d2);
  law.x_per_divisor = d2 > 0.0 ? xd / law.u_divisor : 0.0;
  law.u_rest = std::sqrt(std::max(0.0, x2 - law.x_per_divisor * law.x_per_divisor));
  return law;
}

double draw(double value, const Law& law, Draws& draws) {
  const double d = law.u_divisor > 0.0 ? draws.normal() : 0.0;
  double x = value + law.x_per_divisor * d + law.u_rest * draws.normal();
  for (std::size_t a = 0; a < kDirectionAxes; ++a) {
    if (law.u_angle[a] == 0.0) continue;
    const double angle = law.u_angle[a] * draws.normal();
    x += angle * (law.slope[a] + law.bend[a] * angle);
  }
  for (const double half : law.rectangles) x += half * (2.0 * draws.even() - 1.0);
  for (const double u2 : law.arcsine2) {
    if (u2 > 0.0) x += std::sqrt(2.0 * u2) * std::cos(2.0 * std::numbers::pi * draws.even());
  }
  return x / (1.0 + law.u_divisor * d);
}

double quantile(std::vector<double>& values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + place);
  return values[static_cast<std::size_t>(place)];
}

double scatter_of(const std::vector<double>& values) {
  double mean = 0.0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  double squares = 0.0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

}  // namespace

double relative_divisor(const TermList& terms) {
  double squares = 0.0;
  for (const TermList::DivisorTerm& term : terms.divisor()) squares += term.relative * term.relative;
  return std::sqrt(squares);
}

bool needs_monte_carlo(const Budget& budget, const TermList& terms, const Nonlinearity& bent) {
  constexpr double kDivisor = 0.05;
  constexpr double kSecondOrder = 0.1;
  if (relative_divisor(terms) > kDivisor) return true;
  double second2 = 0.0;  // the variance of c d^2 / 2 is (c u^2)^2 / 2, its mean c u^2 / 2
  for (std::size_t a = 0; a < kDirectionAxes; ++a) {
    const double bend = 0.5 * bent.curvature[a] * bent.u_angle[a] * bent.u_angle[a];
    second2 += bend * bend;
  }
  return std::sqrt(second2) > kSecondOrder * budget.u.si();
}

void propagate_by_monte_carlo(double value, const TermList& terms, const Nonlinearity& bent, std::uint64_t stream,
                              Budget& budget) {
  constexpr double kTail = 0.5 * (1.0 - 0.9545);
  const Law law = law_of(value, budget, terms, bent);
  Draws draws(stream);
  std::vector<double> values(kMonteCarloTrials);
  for (double& v : values) v = draw(value, law, draws);
  const double low = quantile(values, kTail);
  const double high = quantile(values, 1.0 - kTail);
  const double widened = coverage_factor(budget.degrees_of_freedom) / 2.0;
  budget.method = BudgetMethod::MonteCarlo;
  budget.below = per_steradian(widened * std::max(0.0, value - low));
  budget.above = per_steradian(widened * std::max(0.0, high - value));
  budget.expanded = std::max(budget.below, budget.above);
  // A ratio whose divisor comes near 0 has no standard deviation: there half of the interval stands for it.
  constexpr double kHasMoments = 0.2;
  budget.u =
      law.u_divisor < kHasMoments ? per_steradian(scatter_of(values)) : 0.5 * (budget.below + budget.above) / 2.0;
  budget.k = budget.u > Brdf{} ? budget.expanded / budget.u : 2.0;
}

}  // namespace gonio::calibration
