#include "calibration/drift_bridge.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gonio::calibration {
namespace {

double covariance(const BridgeParts& a, const BridgeParts& b) {
  double sum = 0.0;
  for (std::size_t k = 0; k < kBridgeModes; ++k) sum += a.mode[k] * b.mode[k];
  return sum;
}

TEST(DriftBridge, HasTheVarianceOfAStepAtAMomentThatNobodyKnows) {
  for (const double p : {0.01, 0.3, 0.5, 0.9}) {
    const BridgeParts parts = bridge_at(p);
    // The line is off by p, or by 1 - p where the step lies before p: p (1 - p)^2 + (1 - p) p^2.
    EXPECT_NEAR(covariance(parts, parts) + parts.rest * parts.rest, p * (1.0 - p), 1e-15) << p;
  }
}

TEST(DriftBridge, BetweenTwoReadingsOnlyWhatLiesBetweenThemCounts) {
  const BridgeParts parts = bridge_between(0.2, 0.9);

  EXPECT_NEAR(covariance(parts, parts) + parts.rest * parts.rest, 0.7 * 0.3, 1e-15);
  EXPECT_EQ(bridge_between(0.4, 0.4).rest, 0.0);
  EXPECT_EQ(covariance(bridge_between(0.4, 0.4), parts), 0.0);
}

// Two points of one block, each read on the sample and half an interval later on the reference: a step between both
// samples, and likewise between both references, errs the two to opposite sides.
TEST(DriftBridge, PointsOfOneBlockDoNotErrAsOne) {
  const BridgeParts first = bridge_between(0.0, 0.5);
  const BridgeParts last = bridge_between(0.4, 0.9);

  // cov = |overlap of both stretches| - product of their lengths.
  EXPECT_NEAR(covariance(first, last), 0.1 - 0.25, 0.02);
  EXPECT_LT(first.rest * first.rest, 0.15 * 0.25) << "most is in the modes";
}

}  // namespace
}  // namespace gonio::calibration
