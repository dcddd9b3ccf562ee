#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "reflectance/batch/vector_math.h"
#include "reflectance/surface/glint.h"
#include "reflectance/surface/hapke.h"
#include "reflectance/surface/lambertian.h"
#include "reflectance/surface/minnaert.h"
#include "reflectance/surface/rpv.h"
#include "reflectance/surface/water_body.h"
#include "tests/reflectance/batch/batch_surfaces.h"
#include "tests/reflectance/printed.h"

namespace gonio::reflectance {
namespace {

constexpr std::uint64_t kSeed = 20260202;

std::vector<Direction> generated(std::size_t count, std::uint64_t seed) {
  GeneratedDirections directions(seed);
  std::vector<Direction> views;
  while (views.size() < count) views.push_back(directions.next());
  return views;
}

std::vector<Brdf> evaluated_fast(const Surface& s, const Direction& i, std::span<const Direction> r) {
  std::vector<Brdf> out(r.size());
  s.eval_fast(i, r, out);
  return out;
}

double one(const Surface& s, const Direction& i, const Direction& r) {
  return evaluated_fast(s, i, {&r, 1}).front().si();
}

TEST(FastEvaluation, StaysWithinItsBoundForEveryModel) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  for (const Surface& s : batch_surfaces()) {
    const FastError worst = worst_fast_error(s, 6'400, kSeed);
    EXPECT_LE(worst.bound_share, 1.0) << s.model();
    EXPECT_TRUE(worst.is_valid) << s.model();
  }
}

TEST(FastEvaluation, HasAKernelForEveryNamedModelButThoseOfFacets) {
  for (const Surface& s : batch_surfaces()) {
    const bool is_of_facets = s.model() == "ggx" || s.model() == "beckmann";
    EXPECT_EQ(s.fast_path().has_kernel, !is_of_facets) << s.model();
    EXPECT_LE(s.fast_path().relative_error, 1e-12) << s.model();
  }
  EXPECT_LE(wheat().fast_path().relative_error, 3e-15);
  EXPECT_LE(sea().fast_path().relative_error, 1e-12);
}

TEST(FastEvaluation, GivesTheSameBitsAsTheExactWhereNoElementaryFunctionIsLeft) {
  const std::vector<Direction> views = generated(1000, kSeed);
  for (const Surface& s : batch_surfaces()) {
    if (s.fast_path().relative_error > 0.0) continue;
    std::vector<Brdf> exact(views.size());
    for (std::size_t k = 0; k < 50; ++k) {
      s.eval(views[k], views, exact);
      EXPECT_EQ(evaluated_fast(s, views[k], views), exact) << s.model();
    }
  }
}

// Nothing but f: what a model of someone else's offers at least.
struct Plain {
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    return per_steradian(i.mu() + 2.0 * r.theta().si() + 3.0 * r.phi().si() + 0.1 * r.elevation().si() * r.sin_theta());
  }
  [[nodiscard]] std::string_view model() const { return "plain"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return false; }
};

TEST(FastEvaluation, IsTheExactOneForAModelWithoutAKernelAndSaysSo) {
  const std::vector<Direction> views = generated(100, kSeed);
  const Surface plain = Plain{};
  const Surface sum = SurfaceSum::make({{plain, 0.5}, {surface("lambertian", {{"rho", 0.4}}), 2.0}}).value();

  EXPECT_EQ(plain.fast_path(), FastPath{});
  EXPECT_TRUE(sum.fast_path().has_kernel);
  EXPECT_EQ(sum.fast_path().relative_error, 0.0);
  for (const Surface& s : {plain, sum}) {
    std::vector<Brdf> exact(views.size());
    s.eval(views[3], views, exact);
    EXPECT_EQ(evaluated_fast(s, views[3], views), exact);
  }
}

TEST(FastEvaluation, GivesTheSameBitsHoweverABatchIsSplit) {
  const std::vector<Direction> views = generated(333, kSeed);
  const Direction i = Direction::from_angles(degrees(40.0), degrees(-170.0));
  for (const Surface& s : batch_surfaces()) {
    const std::vector<Brdf> whole = evaluated_fast(s, i, views);
    for (const std::size_t step : {1u, 7u, 64u, 100u}) {
      std::vector<Brdf> parts;
      for (std::size_t first = 0; first < views.size(); first += step) {
        const std::size_t count = std::min(step, views.size() - first);
        for (const Brdf f : evaluated_fast(s, i, std::span(views).subspan(first, count))) parts.push_back(f);
      }
      EXPECT_EQ(parts, whole) << s.model() << " by " << step;
    }
  }
}

TEST(FastEvaluation, GivesTheSameBitsFromSeveralThreads) {
  const std::vector<Direction> views = generated(1000, kSeed);
  const Direction i = Direction::from_angles(degrees(40.0), {});
  for (const Surface& s : {wheat(), sea("cox_munk_smith"), surface("hapke_exact_hg", {{"omega0", 0.9}, {"g", 0.4}})}) {
    const std::vector<Brdf> alone = evaluated_fast(s, i, views);
    std::array<std::vector<Brdf>, 4> together;
    {
      std::vector<std::jthread> threads;
      for (std::vector<Brdf>& mine : together) threads.emplace_back([&] { mine = evaluated_fast(s, i, views); });
    }
    for (const std::vector<Brdf>& mine : together) EXPECT_EQ(mine, alone) << s.model();
  }
}

template <class Model>
void expect_same_bits_from_every_unit(const Model& model) {
  const std::vector<Direction> views = generated(DirectionBlock::kSize, kSeed);
  DirectionBlock block;
  block.assign(views);
  for (const Direction& i : generated(100, kSeed + 1)) {
    BrdfBlock baseline;
    model.eval_fast(i, block, baseline, VectorUnit::Baseline);
    for (const VectorUnit unit : {VectorUnit::Avx2, VectorUnit::Avx512}) {
      if (unit > vector_unit()) continue;  // this processor cannot
      BrdfBlock wide;
      model.eval_fast(i, block, wide, unit);
      EXPECT_EQ(wide, baseline) << model.model();
    }
  }
}

TEST(FastEvaluation, GivesTheSameBitsFromEveryVectorUnit) {
  expect_same_bits_from_every_unit(Lambertian::make({.rho = 0.4}).value());
  expect_same_bits_from_every_unit(Minnaert::make({.rho = 0.4, .k = 0.3}).value());
  expect_same_bits_from_every_unit(Hapke::make({.omega0 = 0.9}).value());
  expect_same_bits_from_every_unit(Hapke::make({.omega0 = 0.9, .form = HapkeForm::Exact, .g = 0.3}).value());
  expect_same_bits_from_every_unit(Rpv::make({.rho0 = 0.133, .k = 0.851, .g = -0.114}).value());
  expect_same_bits_from_every_unit(WaterBody::make({.rho_w = 0.4}).value());
  expect_same_bits_from_every_unit(Glint::make({.slope_variance = 0.05}).value());
  expect_same_bits_from_every_unit(Glint::make({.slope_variance = 0.05, .shadowing = Shadowing::Smith}).value());
}

Direction at(double theta, double phi = 0.0) {
  return Direction::from_angles(radians(theta), radians(phi));
}

Direction low(double elevation, double phi = 0.0) {
  return Direction::from_elevation(radians(elevation), radians(phi));
}

TEST(FastEvaluation, MatchesTheTextbookForWheatToTheLastBitsCloseToRetroAndToTheHorizon) {
  EXPECT_TRUE(agrees(one(wheat(), at(0.5), at(0.5 + 0x1p-40)), "0.336907366804167858", 3e-15));
  EXPECT_TRUE(agrees(one(wheat(), at(0.5), at(0.5, 0x1p-40)), "0.33690736680423747", 3e-15));
  EXPECT_TRUE(agrees(one(wheat(), low(0x1p-33), low(0x1p-34, 0.25)), "5359.48496516902597", 3e-15));
  EXPECT_TRUE(agrees(one(wheat(), at(0.75), at(1.25, 2.5)), "0.17099814661315561", 3e-15));
}

TEST(FastEvaluation, MatchesTheTextbookForASea) {
  const Direction i = at(0.75);
  const Direction r = at(1.25, 2.5);
  EXPECT_TRUE(agrees(one(sea(), i, r), "0.00172986512541562344", 5e-15));
  EXPECT_TRUE(agrees(one(sea("cox_munk_smith"), i, r), "0.0017229672100007987", 5e-15));
}

TEST(FastEvaluation, IsFiniteAtThePoleInTheHorizonAndWhereDirectionsCoincide) {
  const Direction hard[] = {at(0.0), low(0.0), low(0.0, 3.0), low(1e-300), at(1e-300), at(0.7)};
  for (const Surface& s : batch_surfaces()) {
    for (const Direction& i : hard) {
      for (const Direction& r : hard) {
        EXPECT_TRUE(std::isfinite(one(s, i, r))) << s.model();
        EXPECT_GE(one(s, i, r), 0.0) << s.model();
        const double exact = s.eval(i, r).si();
        const FastPath path = s.fast_path();
        EXPECT_LE(std::abs(one(s, i, r) - exact), path.relative_error * exact + path.absolute_error.si()) << s.model();
      }
    }
  }
}

TEST(DirectionBlock, GivesBackWhatItWasGiven) {
  const std::vector<Direction> views = generated(40, kSeed);
  DirectionBlock block;
  block.assign(views);

  for (std::size_t k = 0; k < views.size(); ++k) EXPECT_EQ(block.at(k), views[k]);
  EXPECT_EQ(block.at(40), Direction());
}

TEST(VectorMath, IsAsAccurateAsItSays) {
  GeneratedDirections numbers(kSeed);
  const auto error_units = [](double computed, long double truth) {
    return static_cast<double>(std::fabs((computed - truth) / truth)) * 0x1p53;
  };
  for (int k = 0; k < 20'000; ++k) {
    const double turn = 3.14 * numbers.unit();
    const double depth = 1416.0 * (numbers.unit() - 0.5);
    const double base = std::exp(60.0 * (numbers.unit() - 0.95));
    const double exponent = 12.0 * (numbers.unit() - 0.2);
    const double low_side = std::exp(-30.0 * numbers.unit());
    const double v = 6.0 * numbers.unit();
    const long double tail = std::exp(static_cast<long double>(v) * v) * std::erfc(static_cast<long double>(v));
    EXPECT_LE(error_units(lane::sine_of_half_turn(turn), std::sin(static_cast<long double>(turn))), 3.0);
    EXPECT_LE(error_units(lane::exponential(depth), std::exp(static_cast<long double>(depth))), 2.0);
    EXPECT_LE(error_units(lane::exponential_less_one(v), std::expm1(static_cast<long double>(v))), 3.0);
    EXPECT_LE(error_units(lane::exponential_less_one(low_side), std::expm1(static_cast<long double>(low_side))), 3.0);
    EXPECT_LE(error_units(lane::power(base, lane::Exponent(exponent)),
                          std::pow(static_cast<long double>(base), static_cast<long double>(exponent))),
              3.0 + 2.0 * std::abs(exponent));
    EXPECT_LE(error_units(lane::small_angle(low_side, 1.0), std::atan(static_cast<long double>(low_side))), 3.0);
    EXPECT_NEAR(lane::scaled_erfc(v), static_cast<double>(tail), 0x1p-51 * std::exp(v * v));
  }
}

}  // namespace
}  // namespace gonio::reflectance
