#include "calibration/budget.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "calibration/coverage_interval.h"
#include "calibration/student_t.h"

namespace gonio::calibration {
namespace {

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

}  // namespace

double coverage_factor(double degrees_of_freedom) {
  assert(degrees_of_freedom > 0.0);
  constexpr double kAsGoodAsInfinite = 1e5;  // there k differs from its limit by 3e-5
  if (degrees_of_freedom > kAsGoodAsInfinite) return 2.0;
  return student_factor(degrees_of_freedom);
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
