#pragma once

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

/// Raises the level from `first` to at most `last`, until two levels agree to `relative_tolerance`. The difference is
/// taken as the error of the finer one, which for the rules used here is far too careful: theirs is the square of it.
template <class AtLevel>
[[nodiscard]] Integral refined(int first, int last, double relative_tolerance, AtLevel at_level) {
  RuleSum coarse = at_level(first);
  Integral result{.evaluations = coarse.evaluations()};
  for (int level = first + 1; level <= last; ++level) {
    const RuleSum fine = at_level(level);
    result.value = fine.value();
    result.error = std::abs(fine.value() - coarse.value()) + fine.error() + kRuleRounding * fine.size();
    result.evaluations += fine.evaluations();
    if (result.error <= relative_tolerance * fine.size()) break;
    coarse = fine;
  }
  return result;
}

}  // namespace gonio::reflectance
