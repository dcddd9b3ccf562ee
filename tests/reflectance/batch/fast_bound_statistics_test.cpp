// The promise of every kernel, over 1e6 pairs each.
#include <gtest/gtest.h>

#include "tests/reflectance/batch/batch_surfaces.h"

namespace gonio::reflectance {
namespace {

constexpr int kPairs = 1'000'000;
constexpr std::uint64_t kSeed = 20260201;

TEST(FastEvaluation, StaysWithinItsBoundInAMillionPairs) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  for (const Surface& s : batch_surfaces()) {
    const FastError worst = worst_fast_error(s, kPairs, kSeed);
    EXPECT_LE(worst.bound_share, 1.0) << s.model() << " " << ::testing::PrintToString(s.parameters().back().value);
    EXPECT_TRUE(worst.is_valid) << s.model();
  }
}

TEST(FastEvaluation, HasABoundThatIsNoLooserThanTenTimesWhatHappens) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  const Surface surfaces[] = {surface("minnaert", {{"rho", 0.5}, {"k", 0.5}}),
                              surface("minnaert", {{"rho", 0.5}, {"k", 10.0}}),
                              surface("hapke_exact", {{"omega0", 0.9}}),
                              surface("hapke_hg", {{"omega0", 0.9}, {"g", -0.3}}),
                              surface("hapke_exact_hg", {{"omega0", 0.9}, {"g", 0.9}}),
                              wheat(),
                              sea(),
                              sea("cox_munk_smith"),
                              surface("glint", {{"slope_variance", 1e-4}, {"refractive_index", 1.34}})};
  for (const Surface& s : surfaces) {
    EXPECT_GE(worst_fast_error(s, kPairs, kSeed).bound_share, 0.1) << s.model();
  }
}

}  // namespace
}  // namespace gonio::reflectance
