#pragma once

#include <cmath>

namespace gonio::reflectance {

/// A sum whose rounding does not grow with the number of terms (Neumaier 1974): what was lost in each addition is kept
/// apart and added at the end.
class CompensatedSum {
 public:
  void add(double term) {
    const double sum = sum_ + term;
    lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - sum) + term : (term - sum) + sum_;
    sum_ = sum;
  }
  [[nodiscard]] double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0.0;
  double lost_ = 0.0;
};

}  // namespace gonio::reflectance
