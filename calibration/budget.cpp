#include "calibration/budget.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "calibration/coverage_interval.h"

namespace gonio::calibration {
namespace {

constexpr double kLevel = 0.9545;

double square(double x) {
  return x * x;
}

// Ascending by component; equal ones keep their order, so that sums have one order. Most lists come sorted but for a
// few terms.
void sort_terms(std::vector<BudgetTerm>& terms) {
  for (std::size_t n = 1; n < terms.size(); ++n) {
    const BudgetTerm term = terms[n];
    std::size_t place = n;
    for (; place > 0 && terms[place - 1].component > term.component; --place) terms[place] = terms[place - 1];
    terms[place] = term;
  }
}

template <class Add>
void merge_terms(std::vector<BudgetTerm>& terms, Add add) {
  sort_terms(terms);
  std::size_t kept = 0;
  for (std::size_t n = 0; n < terms.size(); ++n) {
    if (kept > 0 && terms[kept - 1].component == terms[n].component) {
      terms[kept - 1].per_sd = add(terms[kept - 1].per_sd, terms[n].per_sd);
    } else {
      terms[kept++] = terms[n];
    }
  }
  terms.resize(kept);
  std::erase_if(terms, [](const BudgetTerm& term) { return term.per_sd == Brdf{}; });
}

double sum_of_squares(std::span<const BudgetTerm> terms) {
  double sum = 0.0;
  for (const BudgetTerm& term : terms) sum += square(term.per_sd.si());
  return sum;
}

// The regularised incomplete beta function I_x(a, b) by Lentz's continued fraction (NIST DLMF 8.17.22), which converges
// fast for x below (a + 1) / (a + b + 2).
double incomplete_beta(double x, double a, double b) {
  if (x <= 0.0) return 0.0;
  if (x > (a + 1.0) / (a + b + 2.0)) return 1.0 - incomplete_beta(1.0 - x, b, a);
  constexpr double kTiny = 1e-300;
  constexpr int kTermsAtMost = 500;
  double c = 1.0;
  double d = 1.0 / std::max(kTiny, 1.0 - (a + b) * x / (a + 1.0));
  double fraction = d;
  for (int m = 1; m <= kTermsAtMost; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1.0) * (a + 2 * m));
    d = 1.0 / (1.0 + even * d);
    c = 1.0 + even / c;
    fraction *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1.0));
    d = 1.0 / (1.0 + odd * d);
    c = 1.0 + odd / c;
    fraction *= c * d;
    if (std::abs(c * d - 1.0) < 1e-15) break;
  }
  const double log_front = a * std::log(x) + b * std::log1p(-x) + std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b);
  return std::exp(log_front) * fraction / a;
}

// The share of Student's t with `nu` degrees of freedom within +-t: I_y(1/2, nu/2), y = t^2 / (nu + t^2).
double share_within(double t, double nu) {
  return incomplete_beta(t * t / (nu + t * t), 0.5, 0.5 * nu);
}

// Student's t at the level, as a series in 1 / nu about the normal z (Abramowitz and Stegun 1964, 26.7.5).
double series_of_t(double nu) {
  constexpr double kNormal = 2.0000024438996;  // of 0.9545; the tables' 2.000
  const double z = kNormal;
  const double z2 = z * z;
  const double g1 = z * (z2 + 1.0) / 4.0;
  const double g2 = z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
  const double g3 = z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
  const double g4 = z * ((((79.0 * z2 + 776.0) * z2 + 1482.0) * z2 - 1920.0) * z2 - 945.0) / 92160.0;
  return z + (g1 + (g2 + (g3 + g4 / nu) / nu) / nu) / nu;
}

}  // namespace

double coverage_factor(double degrees_of_freedom) {
  assert(degrees_of_freedom > 0.0);
  constexpr double kAsGoodAsInfinite = 1e5;  // there k differs from its limit by 3e-5
  if (degrees_of_freedom > kAsGoodAsInfinite) return 2.0;
  constexpr double kSeries = 200.0;  // there the series is good to 1e-11
  if (degrees_of_freedom > kSeries) return series_of_t(degrees_of_freedom);
  double low = 2.0;
  double high = 4.0;
  while (share_within(high, degrees_of_freedom) < kLevel && high < 1e9) high *= 2.0;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (share_within(middle, degrees_of_freedom) < kLevel ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Budget make_budget(std::span<const Component> components, std::vector<BudgetTerm>& random,
                   std::vector<BudgetTerm>& shared) {
  merge_terms(random, [](Brdf a, Brdf b) { return Brdf::from_si(std::hypot(a.si(), b.si())); });
  merge_terms(shared, [](Brdf a, Brdf b) { return a + b; });
  Budget budget{.random = random, .shared = shared};
  const double random2 = sum_of_squares(budget.random);
  const double shared2 = sum_of_squares(budget.shared);
  const double u = std::sqrt(random2 + shared2);
  double sum4 = 0.0;     // of u_i^4 / nu_i
  double wander2 = 0.0;  // of all that comes from one estimate
  double wander_dof = std::numeric_limits<double>::infinity();
  double rectangle = 0.0;  // the largest
  for (const auto* terms : {&budget.random, &budget.shared}) {
    for (const BudgetTerm& term : *terms) {
      const Component& component = components[term.component];
      const double size2 = square(term.per_sd.si());
      if (component.is_of_the_wander) {
        wander2 += size2;
        wander_dof = std::min(wander_dof, component.degrees_of_freedom);
      } else if (!std::isinf(component.degrees_of_freedom)) {
        sum4 += square(size2) / component.degrees_of_freedom;
      }
      if (component.distribution == Distribution::Rectangular) rectangle = std::max(rectangle, size2);
    }
  }
  if (!std::isinf(wander_dof)) sum4 += square(wander2) / wander_dof;
  if (sum4 > 0.0) budget.degrees_of_freedom = square(square(u)) / sum4;
  budget.u_random = per_steradian(std::sqrt(random2));
  budget.u_shared = per_steradian(std::sqrt(shared2));
  budget.u = per_steradian(u);
  budget.k = coverage_factor(budget.degrees_of_freedom);
  const double rest = random2 + shared2 - rectangle;
  if (rectangle > 0.25 * rest) {
    budget.method = BudgetMethod::FormulaWithRectangle;
    budget.k *= coverage_factor_with_rectangle(std::sqrt(rectangle / std::max(rest, 1e-12 * rectangle))) / 2.0;
  }
  budget.expanded = budget.k * budget.u;
  budget.below = budget.above = budget.expanded;
  return budget;
}

Measured<Brdf> weighted_sum(std::span<const SumTerm> terms) {
  double value = 0.0;
  double random2 = 0.0;
  std::map<std::uint32_t, double> shared;
  for (const SumTerm& term : terms) {
    value += term.weight * term.value.si();
    random2 += square(term.weight * term.budget->u_random.si());
    for (const BudgetTerm& s : term.budget->shared) shared[s.component] += term.weight * s.per_sd.si();
  }
  double u2 = random2;
  for (const auto& [component, sum] : shared) u2 += square(sum);
  return {.value = per_steradian(value), .u = per_steradian(std::sqrt(u2))};
}

}  // namespace gonio::calibration
