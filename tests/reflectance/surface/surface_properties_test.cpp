// What must hold for every model, whatever the geometry: generated, with the seed in the trace.
#include <gtest/gtest.h>

#include <cmath>

#include "reflectance/surface/lambertian.h"
#include "reflectance/surface/surface_sum.h"
#include "tests/reflectance/generated.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

constexpr int kDraws = 5000;

// Each model once in the middle of its ranges and once at the far ends.
std::vector<Surface> all_surfaces() {
  std::vector<Surface> surfaces;
  for (const ModelSpec& spec : surface_models()) {
    Parameters middle;
    Parameters most;
    for (const ParameterSpec& p : spec.parameters) {
      middle.push_back({std::string(p.name), std::clamp(0.37, p.least, p.most)});
      most.push_back({std::string(p.name), p.most});
    }
    surfaces.push_back(surface(spec.name, middle));
    surfaces.push_back(surface(spec.name, most));
  }
  surfaces.push_back(wheat());
  surfaces.emplace_back(SurfaceSum::make({{wheat(), 0.3}, {sea(), 0.7}, {sea("cox_munk_smith"), 1.1}}).value());
  return surfaces;
}

template <class Check>
void for_generated_pairs(Check check) {
  constexpr std::uint64_t kSeed = 20260101;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  for (const Surface& s : all_surfaces()) {
    SCOPED_TRACE(s.model());
    GeneratedDirections directions(kSeed);
    for (int k = 0; k < kDraws && !::testing::Test::HasFailure(); ++k) {
      const Direction i = directions.next();
      const Direction r = directions.next();
      SCOPED_TRACE(::testing::Message() << "i " << i.theta().si() << " " << i.phi().si() << ", r " << r.theta().si()
                                        << " " << r.phi().si() << " rad");
      check(s, i, r);
    }
  }
}

TEST(EverySurface, IsReciprocalToTheLastBit) {
  for_generated_pairs(
      [](const Surface& s, const Direction& i, const Direction& r) { EXPECT_EQ(s.eval(i, r), s.eval(r, i)); });
}

TEST(EverySurface, IsFiniteAndNotNegativeUpToTheHorizon) {
  for_generated_pairs([](const Surface& s, const Direction& i, const Direction& r) {
    EXPECT_TRUE(std::isfinite(s.eval(i, r).si()));
    EXPECT_GE(s.eval(i, r).si(), 0.0);
  });
  const Direction horizon = Direction::from_elevation({}, {});
  for (const Surface& s : all_surfaces()) {
    SCOPED_TRACE(s.model());
    for (const Direction& r :
         {horizon, mirrored(horizon), Direction(), Direction::from_angles(degrees(90), degrees(7))}) {
      EXPECT_TRUE(std::isfinite(s.eval(horizon, r).si()));
    }
  }
}

TEST(EverySurface, IsUnchangedByATurnOfBothAzimuthsWhenIsotropic) {
  GeneratedDirections directions(7);
  for (const Surface& s : all_surfaces()) {
    SCOPED_TRACE(s.model());
    ASSERT_TRUE(s.is_isotropic());
    for (int k = 0; k < 200; ++k) {
      // A quarter turn of multiples of 2^-10 rad is exact, so that the difference of azimuths keeps its bits.
      const auto at = [](double theta, double phi) { return Direction::from_angles(radians(theta), radians(phi)); };
      const double phi_i = std::floor(1000.0 * directions.unit()) * 0x1p-10;
      const double phi_r = std::floor(1000.0 * directions.unit()) * 0x1p-10;
      const double theta_i = 1.5 * directions.unit();
      const double theta_r = 1.5 * directions.unit();
      EXPECT_EQ(s.eval(at(theta_i, phi_i), at(theta_r, phi_r)),
                s.eval(at(theta_i, phi_i + 1.5), at(theta_r, phi_r + 1.5)));
      EXPECT_EQ(s.eval(at(theta_i, phi_i), at(theta_r, phi_r)), s.eval(at(theta_i, -phi_i), at(theta_r, -phi_r)));
    }
  }
}

TEST(EverySurface, GivesTheSameBitsInABatch) {
  GeneratedDirections directions(11);
  std::vector<Direction> views;
  for (int k = 0; k < 100; ++k) views.push_back(directions.next());
  std::vector<Brdf> batch(views.size());
  const Direction i = directions.next();

  for (const Surface& s : all_surfaces()) {
    s.eval(i, views, batch);
    for (std::size_t k = 0; k < views.size(); ++k) EXPECT_EQ(batch[k], s.eval(i, views[k])) << s.model();
  }
}

TEST(EverySurface, IsTheSameFromAGeometryAsFromItsDirections) {
  const Geometry g = geometry(33, 54, 210);
  for (const Surface& s : all_surfaces()) {
    EXPECT_EQ(s.eval(g), s.eval(incident_direction(g), reflected_direction(g))) << s.model();
  }
}

TEST(EverySurface, BecomesLambertianInItsLimits) {
  const double lambertian = 0.4 / std::numbers::pi;
  const Geometry g = geometry(33, 54, 210);

  EXPECT_DOUBLE_EQ(surface("minnaert", {{"rho", 0.4}, {"k", 0.0}}).eval(g).si(), lambertian);
  EXPECT_DOUBLE_EQ(surface("rpv", {{"rho0", 1.0}, {"k", 1.0}, {"g", 0.0}}).eval(g).si(), 1.0);
  // H -> 1 as omega0 -> 0 with a = 2: single scattering alone, omega0/(4 pi (mu_i + mu_r)).
  const double sum = std::cos(degrees(33).si()) + std::cos(degrees(54).si());
  EXPECT_NEAR(surface("hapke", {{"omega0", 1e-9}}).eval(g).si() * 4.0 * std::numbers::pi * sum / 1e-9, 1.0, 2e-9);
}

TEST(SurfaceSum, IsTheWeightedSumOfItsTerms) {
  const Surface sum = SurfaceSum::make({{wheat(), 0.25}, {sea(), 2.0}}).value();
  const Geometry g = geometry(30, 40, 170);

  EXPECT_DOUBLE_EQ(sum.eval(g).si(), 0.25 * wheat().eval(g).si() + 2.0 * sea().eval(g).si());
  EXPECT_EQ(sum.model(), "sum");
  EXPECT_EQ(sum.terms().size(), 2u);
  EXPECT_EQ(sum.parameters().front(), (NamedNumber{"1.weight", 0.25}));
  EXPECT_EQ(sum.parameters().back(), (NamedNumber{"2.refractive_index", 1.34}));
}

TEST(SurfaceSum, RefusesNoTermsAndBadWeights) {
  EXPECT_EQ(SurfaceSum::make({}).error().code, ErrorCode::InvalidInput);
  EXPECT_EQ(SurfaceSum::make({{wheat(), 1.0}, {sea(), -0.1}}).error().seen, "2.weight = -0.1");
  EXPECT_FALSE(SurfaceSum::make({{wheat(), std::nan("")}}));
}

// A brushed metal's like: brighter along phi = 0, and one-sided. Only for these tests.
struct Brushed {
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    return per_steradian(0.1 + 0.05 * std::cos(2.0 * i.phi().si()) * i.sin_theta() + 0.02 * std::sin(r.phi().si()));
  }
  [[nodiscard]] std::string_view model() const { return "brushed"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return false; }
};

TEST(Surface, HoldsAModelOfSomeoneElsesAndGivesItBack) {
  const Surface s = Brushed{};

  EXPECT_FALSE(s.is_isotropic());
  EXPECT_NE(s.as<Brushed>(), nullptr);
  EXPECT_EQ(s.as<Lambertian>(), nullptr);
  EXPECT_EQ(s.closed_rho_dh(Direction()), std::nullopt);
  EXPECT_EQ(s.specular(Direction()), 0.0);
  EXPECT_EQ(s.feature(), Feature::Smooth);
  EXPECT_TRUE(s.terms().empty());
}

}  // namespace
}  // namespace gonio::reflectance
