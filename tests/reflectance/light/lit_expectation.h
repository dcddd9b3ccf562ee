#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reflectance/light/lit_reflectance.h"
#include "tests/reflectance/printed.h"

namespace gonio::reflectance {

/// Within `tolerance` of what is expected, and within the error that the result itself claims.
inline void expect_close(const Result<LitIntegral>& result, double expected, double tolerance, double known = 1e-14) {
  ASSERT_TRUE(result) << describe(result.error());
  const double off = std::abs(result->value - expected);
  EXPECT_LE(off, (tolerance + known) * std::abs(expected)) << "computed " << ::testing::PrintToString(result->value);
  EXPECT_LE(off, result->error + known * std::abs(expected)) << "claimed " << result->error;
}

/// As above, and no further from what was asked for than twice the tolerance.
inline void expect_value(const Result<LitIntegral>& result, const Printed& expected, double tolerance) {
  expect_close(result, expected.value(), tolerance, std::max(1e-14, expected.half_last_digit()));
  ASSERT_TRUE(result);
  EXPECT_LE(result->error, (2.0 * tolerance + 1e-14) * std::abs(result->value));
}

}  // namespace gonio::reflectance
