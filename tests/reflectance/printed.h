#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

namespace gonio::reflectance {

/// A reference value as it was printed: its digits say how far it can be trusted.
class Printed {
 public:
  Printed(const char* text) : text_(text), value_(std::strtod(text, nullptr)) {}  // NOLINT: a literal is a value

  [[nodiscard]] double value() const { return value_; }
  [[nodiscard]] const std::string& text() const { return text_; }
  /// Half a unit of the last digit printed, relative.
  [[nodiscard]] double half_last_digit() const {
    const std::string mantissa = text_.substr(0, text_.find('e'));
    const std::size_t point = mantissa.find('.');
    const std::size_t decimals = point == std::string::npos ? 0 : mantissa.size() - point - 1;
    const double exponent = text_.find('e') == std::string::npos ? 0.0 : std::atof(text_.c_str() + text_.find('e') + 1);
    return 0.5 * std::pow(10.0, exponent - static_cast<double>(decimals)) / std::abs(value_);
  }

 private:
  std::string text_;
  double value_;
};

/// Agreement to half the last digit printed or to `relative`, whichever is wider.
inline ::testing::AssertionResult agrees(double computed, const Printed& expected, double relative) {
  const double error = std::abs(computed - expected.value()) / std::abs(expected.value());
  const double allowed = std::max(relative, expected.half_last_digit());
  if (error <= allowed) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "computed " << ::testing::PrintToString(computed) << ", expected "
                                       << expected.text() << ": relative error " << error << ", allowed " << allowed;
}

}  // namespace gonio::reflectance
