#include "reflectance/check/reciprocity_gap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "reflectance/check/hard_pairs.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

TEST(UlpDistance, CountsTheDoublesBetween) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(ulp_distance(1.0, 1.0), 0u);
  EXPECT_EQ(ulp_distance(0.0, -0.0), 0u);
  EXPECT_EQ(ulp_distance(1.0, std::nextafter(1.0, 2.0)), 1u);
  EXPECT_EQ(ulp_distance(std::nextafter(1.0, 0.0), std::nextafter(1.0, 2.0)), 2u);
  EXPECT_EQ(ulp_distance(std::nextafter(0.0, -1.0), std::nextafter(0.0, 1.0)), 2u);
  EXPECT_EQ(ulp_distance(-inf, inf), ulp_distance(inf, -inf));
  EXPECT_GT(ulp_distance(-inf, inf), std::uint64_t{1} << 63U);
  EXPECT_EQ(ulp_distance(std::nan(""), 1.0), std::numeric_limits<std::uint64_t>::max());
}

TEST(HardPairs, AreTheSameForASeedAndReachTheCorners) {
  const std::vector<DirectionPair> pairs = hard_pairs(5000, 3);

  EXPECT_EQ(pairs, hard_pairs(5000, 3));
  EXPECT_NE(pairs, hard_pairs(5000, 4));
  const auto count = [&](auto is) { return std::count_if(pairs.begin(), pairs.end(), is); };
  EXPECT_GT(count([](const DirectionPair& p) { return p.i == p.r; }), 10);
  EXPECT_GT(count([](const DirectionPair& p) { return p.r == mirrored(p.i); }), 10);
  EXPECT_GT(count([](const DirectionPair& p) { return p.i.mu() < 1e-6; }), 50);
  EXPECT_GT(count([](const DirectionPair& p) { return p.i.sin_theta() < 1e-6; }), 50);
  EXPECT_GT(count([](const DirectionPair& p) { return phase_angle(p.i, p.r) < radians(1e-6); }), 50);
}

// Lambertian but for a few ulp that depend on the order, as from mu_i * (mu_r * x).
struct NearlyReciprocal {
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    return per_steradian(0.3 * i.mu() * r.mu() + (i.mu() > 0.9 && r.mu() < 0.1 ? 0.01 : 0.0));
  }
  [[nodiscard]] std::string_view model() const { return "nearly_reciprocal"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return true; }
};

TEST(ReciprocityGap, IsNoneForTheModelsAndFoundWhereItIs) {
  const std::vector<DirectionPair> pairs = hard_pairs(20000, 20260401);

  const ReciprocityGap none = worst_reciprocity_gap(wheat(), pairs);
  const ReciprocityGap mirror = worst_reciprocity_gap(surface("fresnel_mirror", {{"refractive_index", 1.34}}), pairs);
  const ReciprocityGap broken = worst_reciprocity_gap(NearlyReciprocal{}, pairs);

  EXPECT_EQ(none.ulps, 0u);
  EXPECT_EQ(none.compared, 20000u);
  EXPECT_EQ(mirror.ulps, 0u);
  EXPECT_GT(broken.ulps, 1000u);
  EXPECT_EQ(broken.compared, 20000u);
  EXPECT_FALSE(broken.is_specular);
  const bool is_there =
      std::max(broken.pair.i.mu(), broken.pair.r.mu()) > 0.9 && std::min(broken.pair.i.mu(), broken.pair.r.mu()) < 0.1;
  EXPECT_TRUE(is_there) << broken.forth << " " << broken.back;
}

}  // namespace
}  // namespace gonio::reflectance
