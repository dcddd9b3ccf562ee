#include <gtest/gtest.h>

#include <algorithm>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/sampling/any_incidence_sampler.h"
#include "reflectance/sampling/facet_sampler.h"
#include "reflectance/sampling/make_sampler.h"
#include "reflectance/sampling/table_sampler.h"
#include "reflectance/surface/make_surface.h"
#include "tests/reflectance/sampling/hemisphere_bins.h"
#include "tests/reflectance/sampling/sampled_surfaces.h"

namespace gonio::reflectance {
namespace {

constexpr std::uint64_t kSeed = 20261122;
constexpr std::uint64_t kDraws = 10'000'000;
constexpr std::array kThetas{0.0, 30.0, 60.0, 85.0};

// Draws into the bins; the largest weight met.
double draw(const DirectionSampler& sampler, std::uint64_t draws, HemisphereBins& bins) {
  constexpr std::uint64_t kBatch = 1U << 14U;
  SampleArrays arrays(kBatch);
  double most = 0.0;
  for (std::uint64_t first = 0; first < draws; first += kBatch) {
    const SampleBatch batch = arrays.batch().part(0, std::min(kBatch, draws - first));
    sampler.sample(RandomStream(kSeed), first, batch);
    for (const double weight : batch.weight) most = std::max(most, std::abs(weight));
    bins.add(batch);
  }
  return most;
}

void expect_follows(const DirectionSampler& sampler, const Surface& surface, const Direction& i,
                    std::uint64_t draws = kDraws) {
  HemisphereBins bins(surface, i);
  const double most = draw(sampler, draws, bins);

  const ChiSquare chi = bins.chi_square();
  SCOPED_TRACE(::testing::Message() << "chi-square " << chi.value << " with " << chi.freedom << " degrees of freedom, "
                                    << sampler.report().cells << " cells");
  if (chi.freedom > 0.5) {  // a mirror alone has none
    EXPECT_GT(chi.p, 1e-4);
    EXPECT_LT(chi.p, 1.0 - 1e-4);
  }
  const Integral rho = rho_dh(surface, i, 1e-9);
  EXPECT_NEAR(bins.mean_weight(), rho.value, 4.0 * bins.mean_deviation() + rho.error + 1e-6 * rho.value);
  EXPECT_NEAR(bins.total(), rho.value, 1e-5 * rho.value) << "the bins' own integral";
  EXPECT_LE(most, sampler.report().most_weight * (1.0 + 1e-12));
}

class SamplingStatistics : public ::testing::TestWithParam<NamedSurface> {};

TEST_P(SamplingStatistics, TenMillionDirectionsFollowTheBrdfAndCarryItsLight) {
  for (const double theta : kThetas) {
    const Direction i = Direction::from_angles(degrees(theta), degrees(40.0));
    SCOPED_TRACE(::testing::Message() << "theta_i " << theta << " deg, seed " << kSeed);
    expect_follows(*make_sampler(GetParam().surface, i).value(), GetParam().surface, i);
  }
}

TEST_P(SamplingStatistics, TenMillionFastDirectionsFollowTheBrdfAsWell) {
  for (const double theta : kThetas) {
    const Direction i = Direction::from_angles(degrees(theta), degrees(40.0));
    SCOPED_TRACE(::testing::Message() << "theta_i " << theta << " deg, seed " << kSeed);
    // Clear of what 1e7 draws can see: 1 over their root is 3e-4.
    const SamplerOptions fast{.use = TableUse::Fast, .accuracy = 1e-4, .most_cells = 1U << 18U};
    expect_follows(*make_sampler(GetParam().surface, i, fast).value(), GetParam().surface, i);
  }
}

TEST(SamplingStatistics, OfFacetsFollowTheGlint) {
  for (const char* model : {"glint", "glint_smith"}) {
    const Surface rough = surface(model, {{"slope_variance", 0.05}, {"refractive_index", 1.34}});
    for (const double theta : kThetas) {
      const Direction i = Direction::from_angles(degrees(theta), degrees(40.0));
      SCOPED_TRACE(::testing::Message() << model << ", theta_i " << theta << " deg, seed " << kSeed);
      expect_follows(FacetSampler(*rough.as<Glint>(), i), rough, i, 2'000'000);
    }
  }
}

TEST(SamplingStatistics, OfRowsFollowTheBrdfBetweenThem) {
  const Surface glossy = sum_of({{wheat(), 0.6}, {surface("fresnel_mirror", {{"refractive_index", 1.5}}), 1.0}});
  for (const Surface& tested : {glossy, surface("hapke_exact_hg", {{"omega0", 0.9}, {"g", -0.3}})}) {
    const AnyIncidenceSampler sampler = AnyIncidenceSampler::make(tested).value();
    for (const double theta : {0.0, 33.3, 61.7, 85.0}) {
      SCOPED_TRACE(::testing::Message() << tested.model() << ", theta_i " << theta << " deg, seed " << kSeed << ", "
                                        << sampler.rows() << " rows");
      const Direction i = Direction::from_angles(degrees(theta), degrees(40.0));
      HemisphereBins bins(tested, i);
      for (std::uint64_t k = 0; k < 1'000'000; ++k) {
        const DirectionSample sample = sampler.sample(i, RandomStream(kSeed), k);
        const Vector r = sample.r.vector();
        bins.add(r.x, r.y, r.z, sample.weight, sample.is_specular);
      }
      EXPECT_GT(bins.chi_square().p, 1e-4);
      EXPECT_LT(bins.chi_square().p, 1.0 - 1e-4);
      EXPECT_NEAR(bins.mean_weight(), rho_dh(tested, i).value, 4.0 * bins.mean_deviation());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EachModel, SamplingStatistics, ::testing::ValuesIn(sampled_surfaces()),
                         [](const auto& tested) { return tested.param.name; });

TEST(SamplingStatistics, AreOfEveryModelThatThereIs) {
  const std::vector<NamedSurface> all = sampled_surfaces();
  for (const ModelSpec& spec : surface_models()) {
    EXPECT_TRUE(std::ranges::any_of(all, [&](const NamedSurface& s) { return s.name == spec.name; })) << spec.name;
  }
}

// The same draws spoilt: the test has to see it.
template <class Spoil>
double p_of_spoilt(const Surface& surface, const SamplerOptions& options, Spoil spoil) {
  const Direction i = Direction::from_angles(degrees(60.0), {});
  const auto sampler = TableSampler::make(surface, i, options).value();
  HemisphereBins bins(surface, i);
  SampleArrays arrays(1'000'000);
  const SampleBatch batch = arrays.batch();
  sampler->sample(RandomStream(kSeed), 0, batch);
  for (std::size_t n = 0; n < batch.size(); ++n) spoil(batch, n, sampler->report());
  bins.add(batch);
  return bins.chi_square().p;
}

TEST(ChiSquareOfSampling, SeesADroppedWeight) {
  const SamplerOptions coarse{.accuracy = 0.1, .most_cells = 512};
  const auto drop = [](const SampleBatch& b, std::size_t n, const SamplerReport& r) { b.weight[n] = r.rho_dh; };
  EXPECT_LT(p_of_spoilt(sea(), coarse, drop), 1e-10);
  EXPECT_GT(p_of_spoilt(sea(), coarse, [](const SampleBatch&, std::size_t, const SamplerReport&) {}), 1e-4);
}

TEST(ChiSquareOfSampling, SeesATurnOfPhiByHalfACell) {
  const auto turn = [](const SampleBatch& b, std::size_t n, const SamplerReport&) {
    const double c = std::cos(std::numbers::pi / 512.0);
    const double s = std::sin(std::numbers::pi / 512.0);
    const double x = b.x[n];
    b.x[n] = c * x - s * b.y[n];
    b.y[n] = s * x + c * b.y[n];
  };
  EXPECT_LT(p_of_spoilt(sea(), {}, turn), 1e-10);
}

}  // namespace
}  // namespace gonio::reflectance
