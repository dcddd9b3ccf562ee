#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "reflectance/integral/compensated_sum.h"
#include "reflectance/integral/integral.h"

namespace gonio::reflectance {

/// The weighted sum of one rule. `size` is that of the absolute terms: what a relative tolerance means where signs
/// change.
class RuleSum {
 public:
  void add(double term) {
    value_.add(term);
    size_.add(std::abs(term));
    ++evaluations_;
  }
  /// A term that is itself an integral: its error and cost are carried along.
  void add(const Integral& part, double weight) {
    value_.add(weight * part.value);
    size_.add(std::abs(weight * part.value));
    error_ += weight * part.error;
    evaluations_ += part.evaluations;
  }
  /// `count` terms that somebody else has added up, each known to `relative_error`.
  void add(double value, double size, double relative_error, std::uint64_t count) {
    value_.add(value);
    size_.add(size);
    error_ += relative_error * size;
    evaluations_ += count;
  }
  [[nodiscard]] double value() const { return value_.value(); }
  [[nodiscard]] double size() const { return size_.value(); }
  [[nodiscard]] double error() const { return error_; }
  [[nodiscard]] std::uint64_t evaluations() const { return evaluations_; }

 private:
  CompensatedSum value_;
  CompensatedSum size_;
  double error_ = 0.0;  ///< of the terms
  std::uint64_t evaluations_ = 0;
};

/// Of nodes, weights and their products, relative; sums are compensated.
constexpr double kRuleRounding = 1e-15;

/// Of a refinement with all that is nested in it: seconds for a formula, a minute for a table of readings.
constexpr std::uint64_t kMostRefinedEvaluations = 100'000'000;

/// Raises the level from `first` to at most `last`, until two levels agree to `relative_tolerance`. The difference is
/// taken as the error of the finer one, which for the rules used here is far too careful: theirs is the square of it.
/// Where an integrand may be rough, two levels can agree by chance: then `doubt` of the step before counts too. No
/// level is begun that, costing twice the one before, would lead beyond kMostRefinedEvaluations.
template <class AtLevel>
[[nodiscard]] Integral refined(int first, int last, double relative_tolerance, AtLevel at_level, double doubt = 0.0) {
  RuleSum coarse = at_level(first);
  Integral result{.evaluations = coarse.evaluations()};
  double last_step = std::abs(coarse.value());
  for (int level = first + 1; level <= last; ++level) {
    const RuleSum fine = at_level(level);
    const double step = std::abs(fine.value() - coarse.value());
    result.value = fine.value();
    result.error = std::max(step, doubt * last_step) + fine.error() + kRuleRounding * fine.size();
    result.evaluations += fine.evaluations();
    if (result.error <= relative_tolerance * fine.size()) break;
    if (result.evaluations + 2 * fine.evaluations() > kMostRefinedEvaluations) break;
    last_step = step;
    coarse = fine;
  }
  return result;
}

}  // namespace gonio::reflectance
