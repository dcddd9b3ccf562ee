#include "calibration/budget.h"

#include <algorithm>
#include <array>
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
void merge_terms(std::vector<BudgetTerm>& terms, Add add, TermColumns& made) {
  sort_terms(terms);
  for (std::size_t n = 0; n < terms.size(); ++n) {
    BudgetTerm term = terms[n];
    for (; n + 1 < terms.size() && terms[n + 1].component == term.component; ++n) {
      term.per_sd = add(term.per_sd, terms[n + 1].per_sd);
    }
    if (term.per_sd != Brdf{}) made.add(term);
  }
}

/// What k depends on, from the squares of independent errors as they come.
class CoverageParts {
 public:
  void add(const Component& component, double size2) {
    all2_ += size2;
    if (component.is_of_the_wander) {
      wander2_ += size2;
      wander_dof_ = std::min(wander_dof_, component.degrees_of_freedom);
    } else if (!std::isinf(component.degrees_of_freedom)) {
      sum4_ += square(size2) / component.degrees_of_freedom;
    }
    if (component.distribution == Distribution::Arcsine) arcsine2_[component.unknown_angle] += size2;
    if (component.distribution == Distribution::Rectangular) rectangle2_ = std::max(rectangle2_, size2);
  }

  /// JCGM 100:2008, eq G.2b.
  [[nodiscard]] double degrees_of_freedom() const {
    const double sum4 = sum4_ + (std::isinf(wander_dof_) ? 0.0 : square(wander2_) / wander_dof_);
    return sum4 > 0.0 ? square(all2_) / sum4 : std::numeric_limits<double>::infinity();
  }

  /// The excess kurtosis, -6/5 of a rectangle and -3/2 of an arcsine times the squares of their shares, says whether k
  /// is another one. The bound is that of a rectangle of half the rest's u, where k falls by 0.3 %.
  [[nodiscard]] bool are_bounds_felt() const {
    constexpr double kFelt = 1.2 * 0.2 * 0.2;
    double excess = 1.2 * square(rectangle2_);
    for (const double part : arcsine2_) excess += 1.5 * square(part);
    return excess > kFelt * square(all2_);
  }

  [[nodiscard]] double k(double degrees_of_freedom) const {
    const double student = coverage_factor(degrees_of_freedom);
    if (!are_bounds_felt()) return student;
    double rest2 = all2_ - rectangle2_;
    std::array<double, kUnknownAngles> arcsines{};
    for (std::size_t n = 0; n < kUnknownAngles; ++n) {
      arcsines[n] = std::sqrt(arcsine2_[n]);
      rest2 -= arcsine2_[n];
    }
    const double normal = std::sqrt(std::max(0.0, rest2));
    return student * coverage_factor_with_bounds(normal, std::sqrt(rectangle2_), arcsines) / 2.0;
  }

 private:
  double all2_ = 0.0;
  double sum4_ = 0.0;     // of u_i^4 / nu_i
  double wander2_ = 0.0;  // of all that comes from one estimate
  double wander_dof_ = std::numeric_limits<double>::infinity();
  double rectangle2_ = 0.0;                        // the largest; others are near enough to normal together
  std::array<double, kUnknownAngles> arcsine2_{};  // of each angle
};

}  // namespace

double coverage_factor(double degrees_of_freedom) {
  assert(degrees_of_freedom > 0.0);
  constexpr double kAsGoodAsInfinite = 1e5;  // there k differs from its limit by 3e-5
  if (degrees_of_freedom > kAsGoodAsInfinite) return 2.0;
  return student_factor(degrees_of_freedom);
}

Budget make_budget(std::span<const Component> components, std::vector<BudgetTerm>& random,
                   std::vector<BudgetTerm>& shared, TermColumns& made) {
  made.begin(random.size() + shared.size());
  merge_terms(
      random, [](Brdf a, Brdf b) { return Brdf::from_si(std::hypot(a.si(), b.si())); }, made);
  const std::size_t randoms = made.size();
  merge_terms(
      shared, [](Brdf a, Brdf b) { return a + b; }, made);
  Budget budget{.random = made.terms(0, randoms), .shared = made.terms(randoms, made.size())};
  CoverageParts parts;
  const auto sum_of_squares = [&](const BudgetTerms& terms) {
    double sum = 0.0;
    for (const BudgetTerm term : terms) {
      const double size2 = square(term.per_sd.si());
      sum += size2;
      parts.add(components[term.component], size2);
    }
    return sum;
  };
  const double random2 = sum_of_squares(budget.random);
  const double shared2 = sum_of_squares(budget.shared);
  budget.u_random = per_steradian(std::sqrt(random2));
  budget.u_shared = per_steradian(std::sqrt(shared2));
  budget.u = per_steradian(std::sqrt(random2 + shared2));
  budget.degrees_of_freedom = parts.degrees_of_freedom();
  budget.k = parts.k(budget.degrees_of_freedom);
  if (parts.are_bounds_felt()) budget.method = BudgetMethod::FormulaWithBounds;
  budget.expanded = budget.k * budget.u;
  budget.below = budget.above = budget.expanded;
  return budget;
}

WeightedSum weighted_sum(std::span<const Component> components, std::span<const SumTerm> terms) {
  double value = 0.0;
  double u2 = 0.0;
  CoverageParts parts;
  const auto add = [&](std::uint32_t component, double size2) {
    u2 += size2;
    parts.add(components[component], size2);
  };
  std::map<std::uint32_t, double> shared;
  for (const SumTerm& term : terms) {
    value += term.weight * term.value.si();
    for (const BudgetTerm& r : term.budget->random) add(r.component, square(term.weight * r.per_sd.si()));
    for (const BudgetTerm& s : term.budget->shared) shared[s.component] += term.weight * s.per_sd.si();
  }
  for (const auto& [component, sum] : shared) add(component, square(sum));
  WeightedSum sum{.value = per_steradian(value), .u = per_steradian(std::sqrt(u2))};
  sum.degrees_of_freedom = parts.degrees_of_freedom();
  sum.k = parts.k(sum.degrees_of_freedom);
  sum.expanded = sum.k * sum.u;
  return sum;
}

}  // namespace gonio::calibration
