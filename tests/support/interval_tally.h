#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

namespace gonio::test {

/// How often stated 95.45 % intervals of one number held its truth, over repetitions drawn anew.
class IntervalTally {
 public:
  IntervalTally(std::string name, double truth) : name_(std::move(name)), truth_(truth) {}

  void add(double value, double expanded) {
    const double off = value - truth_;
    held_ += std::abs(off) <= expanded ? 1 : 0;
    squares_ += off * off;
    half_widths_ += 0.5 * expanded;
    ++count_;
  }

  /// Held 95.45 +- 3 %, and no more than 1.3 times too wide. Prints what was found.
  void expect_true() const {
    const double share = 100.0 * held_ / count_;
    const double ratio = half_widths_ / count_ / std::sqrt(squares_ / count_);
    std::printf("%-24s held %.2f %% of %d, mean(U/2) / RMS error %.3f, U/2 %.2g of it\n", name_.c_str(), share, count_,
                ratio, half_widths_ / count_ / std::abs(truth_));
    EXPECT_NEAR(share, 95.45, 3.0) << name_;
    EXPECT_LE(ratio, 1.3) << name_;
  }

 private:
  std::string name_;
  double truth_;
  int held_ = 0;
  int count_ = 0;
  double squares_ = 0.0;
  double half_widths_ = 0.0;
};

}  // namespace gonio::test
