#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/sampling/any_incidence_sampler.h"
#include "reflectance/sampling/facet_sampler.h"
#include "reflectance/sampling/literal_sampler.h"
#include "reflectance/sampling/make_sampler.h"
#include "reflectance/sampling/table_sampler.h"
#include "tests/reflectance/sampling/hemisphere_bins.h"
#include "tests/reflectance/sampling/sampled_surfaces.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

constexpr std::uint64_t kSeed = 7;

std::vector<double> drawn(const DirectionSampler& sampler, std::size_t size) {
  SampleArrays arrays(size);
  const SampleBatch b = arrays.batch();
  sampler.sample(RandomStream(kSeed), 0, b);
  std::vector<double> all;
  for (std::size_t n = 0; n < size; ++n) all.insert(all.end(), {b.x[n], b.y[n], b.z[n], b.weight[n]});
  return all;
}

HemisphereBins binned(const DirectionSampler& sampler, const Surface& surface, std::size_t size) {
  SampleArrays arrays(size);
  sampler.sample(RandomStream(kSeed), 0, arrays.batch());
  HemisphereBins bins(surface, sampler.incidence());
  bins.add(arrays.batch());
  return bins;
}

TEST(DirectionSampler, DrawsTheSameHoweverTheBatchIsSplit) {
  const Direction i = Direction::from_angles(50.0_deg, 20.0_deg);
  for (const TableUse use : {TableUse::Fast, TableUse::Unbiased}) {
    const auto sampler = make_sampler(sampled_surfaces().back().surface, i, {.use = use, .accuracy = 0.02}).value();
    const std::vector<double> whole = drawn(*sampler, 1000);
    SampleArrays arrays(1000);
    for (std::size_t first = 0; first < 1000; first += 37) {
      const std::size_t count = std::min<std::size_t>(37, 1000 - first);
      sampler->sample(RandomStream(kSeed), first, arrays.batch().part(first, count));
    }
    const SampleBatch b = arrays.batch();
    for (std::size_t n = 0; n < 1000; ++n) {
      ASSERT_EQ(b.x[n], whole[4 * n]);
      ASSERT_EQ(b.y[n], whole[4 * n + 1]);
      ASSERT_EQ(b.z[n], whole[4 * n + 2]);
      ASSERT_EQ(b.weight[n], whole[4 * n + 3]);
    }
  }
}

TEST(DirectionSampler, DrawsTheSameOnAnyNumberOfThreads) {
  const Direction i = Direction::from_angles(50.0_deg, 20.0_deg);
  const auto sampler = make_sampler(wheat(), i, {.use = TableUse::Fast, .accuracy = 0.02}).value();
  constexpr std::size_t kSize = 4000;
  const std::vector<double> alone = drawn(*sampler, kSize);
  SampleArrays arrays(kSize);
  const SampleBatch batch = arrays.batch();
  {
    std::vector<std::jthread> threads;
    for (std::size_t first = 0; first < kSize; first += 1000)
      threads.emplace_back([&, first] { sampler->sample(RandomStream(kSeed), first, batch.part(first, 1000)); });
  }
  for (std::size_t n = 0; n < kSize; ++n) ASSERT_EQ(batch.x[n], alone[4 * n]);
}

TEST(DirectionSampler, DrawsOneAsItDrawsMany) {
  const Direction i = Direction::from_angles(50.0_deg, 20.0_deg);
  const auto sampler = make_sampler(sampled_surfaces().back().surface, i, {.accuracy = 0.02}).value();
  const std::vector<double> many = drawn(*sampler, 200);
  for (std::size_t n = 0; n < 200; ++n) {
    const DirectionSample one = sampler->sample(RandomStream(kSeed), n);
    EXPECT_NEAR(one.r.vector().x, many[4 * n], 1e-15);
    EXPECT_NEAR(one.r.mu(), many[4 * n + 2], 1e-15);
    EXPECT_EQ(one.weight, many[4 * n + 3]);
  }
}

TEST(DrawKernels, GiveTheSameBitsOnEveryVectorUnit) {
  DrawBlock plain;
  for (std::size_t k = 0; k < DrawBlock::kSize; ++k) {
    plain.index[k] = k * 0x123456789abcULL;
    plain.v[k] = static_cast<double>(k) / 63.0;
    plain.w[k] = static_cast<double>(63 - k) / 63.0;
  }
  DrawBlock wide = plain;
  fill_bits(RandomStream(kSeed), plain, VectorUnit::Baseline);
  fill_bits(RandomStream(kSeed), wide);
  fill_directions(0.6, 0.8, plain, VectorUnit::Baseline);
  fill_directions(0.6, 0.8, wide);

  EXPECT_EQ(wide.bits, plain.bits);
  EXPECT_EQ(wide.bits[2][5], RandomStream(kSeed).block(plain.index[5])[2]);
  EXPECT_EQ(wide.x, plain.x);
  EXPECT_EQ(wide.y, plain.y);
  EXPECT_EQ(wide.mu, plain.mu);
}

TEST(HemisphereChart, KeepsTheDigitsOfPoleAndHorizon) {
  for (const double theta : {0.0, 1e-12, 1e-6, 0.3, 1.0}) {
    const Direction d = Direction::from_angles(radians(theta), 30.0_deg);
    EXPECT_NEAR(chart_direction(chart_point(d, {}), {}).theta().si(), theta, 1e-15);
  }
  for (const double elevation : {1e-300, 1e-12, 1e-6, 0.3}) {
    const Direction d = Direction::from_elevation(radians(elevation), 30.0_deg);
    EXPECT_NEAR(chart_direction(chart_point(d, {}), {}).elevation().si() / elevation, 1.0, 2e-15);
  }
}

TEST(HemisphereChart, TurnsLikeCosineAndSine) {
  for (int k = 0; k <= 1000; ++k) {
    const TurnVector turn = turn_vector(k / 1000.0);
    // The argument of the library function is itself rounded, by up to 4e-16 rad.
    EXPECT_NEAR(turn.cosine, std::cos(2.0 * std::numbers::pi * k / 1000.0), 2e-15);
    EXPECT_NEAR(turn.sine, std::sin(2.0 * std::numbers::pi * k / 1000.0), 2e-15);
  }
}

TEST(AliasTable, ChoosesByWeightAndNeverWhatWeighsNothing) {
  const AliasTable table(std::vector<double>{0.0, 1.0, 3.0, 0.0, 4.0});
  std::array<double, 5> counts{};
  for (std::uint64_t k = 0; k < 80000; ++k) {
    const RandomBlock bits = RandomStream(kSeed).block(k);
    counts[table.choose(bits[0], bits[1])] += 1.0;
  }
  EXPECT_EQ(counts[0], 0.0);
  EXPECT_EQ(counts[3], 0.0);
  EXPECT_NEAR(counts[1], 10000.0, 4.0 * std::sqrt(10000.0 * 0.875));
  EXPECT_NEAR(counts[2], 30000.0, 4.0 * std::sqrt(30000.0 * 0.625));
}

TEST(TableSampler, FollowsTheBrdfFromPoleToHorizon) {
  for (const double theta : {0.0, 0.001, 60.0, 89.9}) {
    SCOPED_TRACE(::testing::Message() << "theta_i " << theta << " deg, seed " << kSeed);
    const Direction i = Direction::from_angles(degrees(theta), -100.0_deg);
    const auto sampler = TableSampler::make(wheat(), i, {.accuracy = 0.02}).value();
    const HemisphereBins bins = binned(*sampler, wheat(), 100000);
    EXPECT_GT(bins.chi_square().p, 1e-4);
    EXPECT_NEAR(bins.mean_weight(), rho_dh(wheat(), i).value, 4.0 * bins.mean_deviation());
  }
}

TEST(TableSampler, GivesUnitVectorsAboveTheHorizon) {
  const Direction i = Direction::from_angles(89.9_deg, {});
  const std::vector<double> all = drawn(*TableSampler::make(wheat(), i, {.accuracy = 0.02}).value(), 20000);
  for (std::size_t n = 0; n < all.size(); n += 4) {
    ASSERT_NEAR(std::hypot(all[n], all[n + 1], all[n + 2]), 1.0, 1e-15);
    ASSERT_GT(all[n + 2], 0.0);
    ASSERT_GT(all[n + 3], 0.0);
  }
}

TEST(TableSampler, TellsThatLightIsGained) {
  const auto grazing = TableSampler::make(wheat(), Direction::from_angles(89.9_deg, {}), {.accuracy = 0.02}).value();
  EXPECT_TRUE(grazing->report().gains_energy());
  EXPECT_NEAR(grazing->report().rho_dh, 1.25859712, 1e-7);  // by 30 digits, reference_values.py
  const auto steep = TableSampler::make(wheat(), Direction::from_angles(60.0_deg, {}), {.accuracy = 0.02}).value();
  EXPECT_FALSE(steep->report().gains_energy());
}

TEST(TableSampler, FastHasOneWeightAndTellsAnErrorWithinTheOneAskedFor) {
  const Direction i = Direction::from_angles(30.0_deg, {});
  const auto sampler = TableSampler::make(wheat(), i, {.use = TableUse::Fast, .accuracy = 2e-3}).value();
  EXPECT_LE(sampler->report().total_variation, 2e-3);
  EXPECT_GT(sampler->report().total_variation, 0.0);
  for (const double n : {0.0, 5.0, 99.0})
    EXPECT_EQ(sampler->sample(RandomStream(kSeed), static_cast<std::uint64_t>(n)).weight, sampler->report().rho_dh);
}

TEST(TableSampler, DrawsTheMirrorByItsShareOfTheLight) {
  const Surface glossy = sampled_surfaces().back().surface;
  const Direction i = Direction::from_angles(60.0_deg, 20.0_deg);
  for (const TableUse use : {TableUse::Fast, TableUse::Unbiased}) {
    const auto sampler = TableSampler::make(glossy, i, {.use = use, .accuracy = 0.02}).value();
    int count = 0;
    for (std::uint64_t k = 0; k < 20000; ++k) {
      const DirectionSample sample = sampler->sample(RandomStream(kSeed), k);
      if (!sample.is_specular) continue;
      ++count;
      ASSERT_EQ(sample.r, mirrored(i));
    }
    const double share = glossy.specular(i) / rho_dh(glossy, i).value;
    EXPECT_NEAR(count, 20000.0 * share, 4.0 * std::sqrt(20000.0 * share) + 20000.0 * 0.02 * share);
  }
}

TEST(TableSampler, RefusesAnAccuracyThatItsCellsDoNotReach) {
  const auto refused = TableSampler::make(sea(), Direction::from_angles(60.0_deg, {}),
                                          {.use = TableUse::Fast, .accuracy = 1e-4, .most_cells = 1000});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where->field, "accuracy");
}

TEST(TableSampler, RefusesOptionsOutOfRange) {
  const Direction i;
  EXPECT_EQ(TableSampler::make(wheat(), i, {.accuracy = 0.0}).error().where->field, "accuracy");
  EXPECT_EQ(TableSampler::make(wheat(), i, {.accuracy = NAN}).error().where->field, "accuracy");
  EXPECT_EQ(TableSampler::make(wheat(), i, {.most_cells = 0}).error().where->field, "most_cells");
  EXPECT_EQ(TableSampler::make(wheat(), i, {.use = TableUse::Fast, .negative_values = NegativeValues::Signed})
                .error()
                .where->field,
            "negative_values");
}

// A test surface: its BRDF is any function of r.
struct Formula {
  double (*f)(const Direction& r);
  [[nodiscard]] Brdf eval(const Direction&, const Direction& r) const { return per_steradian(f(r)); }
  [[nodiscard]] std::string_view model() const { return "formula"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return false; }
};

double signed_lobe(const Direction& r) {
  return 0.2 + 0.3 * r.sin_theta() * std::cos(r.phi().si());
}

TEST(TableSampler, RefusesANegativeBrdfUnlessWeightsMayBeSigned) {
  const Surface measured = Formula{signed_lobe};
  const auto refused = TableSampler::make(measured, Direction());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where->field, "surface");

  const auto sampler =
      TableSampler::make(measured, Direction(), {.accuracy = 0.02, .negative_values = NegativeValues::Signed}).value();
  const HemisphereBins bins = binned(*sampler, measured, 100000);
  // The cosine term integrates to nothing: rho_dh = 0.2 pi.
  EXPECT_NEAR(bins.mean_weight(), 0.2 * std::numbers::pi, 4.0 * bins.mean_deviation());
  EXPECT_GT(bins.chi_square().p, 1e-4);
}

TEST(TableSampler, RefusesABrdfThatIsNotFinite) {
  const Surface broken = Formula{[](const Direction& r) { return r.mu() > 0.5 ? 0.1 : NAN; }};
  EXPECT_EQ(TableSampler::make(broken, Direction()).error().where->field, "surface");
}

TEST(TableSampler, FollowsALobeOfAMilliradian) {
  const Surface lobe = surface("glint_smith", {{"slope_variance", 1e-6}, {"refractive_index", 1.34}});
  for (const double theta : {0.0, 60.0, 89.9}) {
    SCOPED_TRACE(::testing::Message() << "theta_i " << theta << " deg, seed " << kSeed);
    const Direction i = Direction::from_angles(degrees(theta), 20.0_deg);
    const auto table = TableSampler::make(lobe, i, {.accuracy = 0.02}).value();
    const FacetSampler facets(*lobe.as<Glint>(), i);
    for (const DirectionSampler* sampler :
         {static_cast<const DirectionSampler*>(table.get()), static_cast<const DirectionSampler*>(&facets)}) {
      const std::vector<double> all = drawn(*sampler, 20000);
      double sum = 0.0;
      double square = 0.0;
      for (std::size_t n = 3; n < all.size(); n += 4) {
        sum += all[n];
        square += all[n] * all[n];
        ASSERT_LE(all[n], sampler->report().most_weight);
      }
      const double mean = sum / 20000.0;
      const double deviation = std::sqrt(std::max(0.0, square / 20000.0 - mean * mean) / 20000.0);
      EXPECT_NEAR(mean, sampler->report().rho_dh, 4.0 * deviation + 1e-6 * mean);
    }
  }
}

TEST(SumSampler, WeighsAllTermsAlikeWhereTheyAreClosed) {
  const Surface sum = sum_of({{surface("lambertian", {{"rho", 0.3}}), 0.5},
                              {surface("fresnel_mirror", {{"refractive_index", 1.5}}), 1.0},
                              {surface("lambertian", {{"rho", 0.0}}), 1.0}});
  const Direction i = Direction::from_angles(60.0_deg, {});
  const auto sampler = make_sampler(sum, i).value();
  EXPECT_EQ(sampler->report().method, SamplingMethod::Sum);
  const HemisphereBins bins = binned(*sampler, sum, 100000);
  EXPECT_NEAR(bins.mean_weight(), rho_dh(sum, i).value, 1e-12);
  EXPECT_GT(bins.chi_square().p, 1e-4);
}

TEST(Samplers, OfABlackSurfaceGiveNoWeight) {
  const Surface black = surface("hapke_hg", {{"omega0", 0.0}, {"g", 0.1}});
  for (const TableUse use : {TableUse::Fast, TableUse::Unbiased})
    EXPECT_EQ(make_sampler(black, Direction(), {.use = use}).value()->sample(RandomStream(1), 0).weight, 0.0);
  EXPECT_EQ(LiteralSampler::make(black).value().sample(Direction(), {.u = 0.5, .v = 0.5}).weight, 0.0);
}

TEST(LiteralSampler, ComesCloserToRhoDhWithTheSquareOfItsCells) {
  const Surface smooth = surface("hapke", {{"omega0", 0.9}});
  const Direction i = Direction::from_angles(60.0_deg, {});
  const double coarse = LiteralSampler::make(smooth, {.theta = 16, .phi = 32}).value().rho_dh_error(i);
  const double fine = LiteralSampler::make(smooth, {.theta = 64, .phi = 128}).value().rho_dh_error(i);
  EXPECT_LT(fine, 1e-3);
  EXPECT_LT(fine, 0.12 * coarse);
}

TEST(LiteralSampler, AgreesWithTheBrdfToItsCells) {
  const Direction i = Direction::from_angles(30.0_deg, {});
  const Surface glossy = sampled_surfaces().back().surface;
  const LiteralSampler literal = LiteralSampler::make(glossy, {.theta = 64, .phi = 128}).value();
  const LiteralSampler::Incidence prepared = literal.incidence(i);
  HemisphereBins bins(glossy, i);
  for (std::uint64_t k = 0; k < 20000; ++k) {
    const DirectionSample sample = literal.sample(prepared, RandomStream(kSeed).point(k));
    const Vector r = sample.r.vector();
    bins.add(r.x, r.y, r.z, sample.weight, sample.is_specular);
  }
  EXPECT_GT(bins.chi_square().p, 1e-4);
  EXPECT_EQ(literal.sample(i, {.u = 0.5, .v = 0.3}).r, literal.sample(prepared, {.u = 0.5, .v = 0.3}).r);
}

TEST(LiteralSampler, RefusesCellsOutOfRange) {
  EXPECT_EQ(LiteralSampler::make(wheat(), {.theta = 0}).error().where->field, "theta");
  EXPECT_EQ(LiteralSampler::make(wheat(), {.phi = 5000}).error().where->field, "phi");
}

TEST(AnyIncidenceSampler, CarriesTheLightOfAnyIncidence) {
  const Surface glossy = sampled_surfaces().back().surface;
  const AnyIncidenceSampler sampler = AnyIncidenceSampler::make(glossy, {.most_rows = 65, .most_ratio = 3.0}).value();
  for (const double theta : {0.0, 17.3, 61.7, 89.99}) {
    SCOPED_TRACE(::testing::Message() << "theta_i " << theta << " deg, seed " << kSeed);
    const Direction i = Direction::from_angles(degrees(theta), 70.0_deg);
    double sum = 0.0;
    double square = 0.0;
    for (std::uint64_t k = 0; k < 5000; ++k) {
      const double weight = sampler.sample(i, RandomStream(kSeed), k).weight;
      sum += weight;
      square += weight * weight;
    }
    const double mean = sum / 5000.0;
    EXPECT_NEAR(mean, rho_dh(glossy, i).value, 4.0 * std::sqrt((square / 5000.0 - mean * mean) / 5000.0));
  }
}

TEST(AnyIncidenceSampler, RefusesWhatItsRowsCannotCarry) {
  EXPECT_EQ(AnyIncidenceSampler::make(Formula{signed_lobe}).error().where->field, "surface");
  EXPECT_EQ(AnyIncidenceSampler::make(wheat(), {.most_rows = 1}).error().where->field, "most_rows");
  const Surface lobe = surface("glint", {{"slope_variance", 1e-3}, {"refractive_index", 1.34}});
  EXPECT_EQ(AnyIncidenceSampler::make(lobe, {.most_rows = 10}).error().where->field, "most_rows");
}

}  // namespace
}  // namespace gonio::reflectance
