// Where the plain way to integrate, to sum or to draw fails and ours must hold. Each test shows both; its name is the
// case's.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>
#include <vector>

#include "reflectance/integral/compensated_sum.h"
#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/integral/hemisphere_integral.h"
#include "reflectance/surface/fresnel.h"
#include "reflectance/surface/surface_sum.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;

Direction at_deg(double theta, double phi = 0.0) {
  return Direction::from_angles(degrees(theta), degrees(phi));
}

double relative_error(double computed, double truth) {
  return std::abs(computed / truth - 1.0);
}

double by_rings(const Surface& surface, const Direction& i, int rings, int azimuths, RingSpacing spacing) {
  CompensatedSum sum;
  for (const HemisphereNode& node : gauss_rings(rings, azimuths, spacing)) {
    sum.add(node.weight_sr * surface.eval(i, node.direction).si());
  }
  return sum.value();
}

TEST(HardCase, RpvAtGrazingByGaussInMu) {
  // k = 0.4: f mu goes with mu^0.4 at the horizon, which no polynomial in mu follows. Lit along the normal, so that the
  // hot spot has no part in it: with rho0 = 1 there is none, and with g = 0 no azimuth either.
  const Surface bowl = surface("rpv", {{"rho0", 1.0}, {"k", 0.4}, {"g", 0.0}});
  const Direction normal;
  const double truth = rho_dh(bowl, normal, 1e-13).value;

  EXPECT_GT(relative_error(by_rings(bowl, normal, 16, 1, RingSpacing::Mu), truth), 1e-5);
  EXPECT_GT(relative_error(by_rings(bowl, normal, 64, 1, RingSpacing::Mu), truth), 5e-7);
  EXPECT_LT(relative_error(by_rings(bowl, normal, 16, 1, RingSpacing::SqrtMu), truth), 1e-6);
  EXPECT_LT(relative_error(by_rings(bowl, normal, 64, 1, RingSpacing::SqrtMu), truth), 1e-8);
}

TEST(HardCase, RpvAtGrazingHotSpot) {
  // Wheat at 60 deg: the kink at retro and the power of mu at the horizon. 0.712386680567085 by 20 digits.
  const double truth = 0.712386680567085;

  EXPECT_GT(relative_error(by_rings(wheat(), at_deg(60), 32, 64, RingSpacing::Mu), truth), 1e-6);
  EXPECT_LT(relative_error(rho_dh(wheat(), at_deg(60), 1e-12).value, truth), 1e-14);
}

// Eq 9 as a function: what it is at a direction.
double naive_mirror(double reflectance, const Direction& i, const Direction& r) {
  return r == mirrored(i) ? 2.0 * reflectance * std::numeric_limits<double>::infinity() : 0.0;
}

TEST(HardCase, FresnelDelta) {
  const Surface mirror = surface("fresnel_mirror", {{"refractive_index", 1.34}});
  const Direction i = at_deg(30);
  const double reflectance = fresnel(i.theta(), 1.34).unpolarised();
  double missed = 0.0;
  for (const HemisphereNode& node : gauss_rings(16, 32)) {
    missed += node.weight_sr * naive_mirror(reflectance, i, node.direction);
  }
  double met = 0.0;
  for (int theta = 0; theta < 90; theta += 10) {
    for (int phi = -170; phi <= 180; phi += 10) met += naive_mirror(reflectance, i, at_deg(theta, phi));
  }

  EXPECT_EQ(missed, 0.0);
  EXPECT_TRUE(std::isinf(met));
  EXPECT_EQ(mirror.eval(i, mirrored(i)).si(), 0.0);
  EXPECT_DOUBLE_EQ(mirror.specular(i), reflectance);
  EXPECT_DOUBLE_EQ(rho_dh(mirror, i).value, reflectance);
  // Beside a diffuse part: rho_dh += R_F, and eval is the diffuse part alone.
  const Surface diffuse = surface("lambertian", {{"rho", 0.4}});
  const Surface both(SurfaceSum::make({{diffuse, 1.0}, {mirror, 1.0}}).value());
  EXPECT_EQ(both.eval(i, mirrored(i)), diffuse.eval(i, mirrored(i)));
  EXPECT_DOUBLE_EQ(rho_dh(both, i).value, 0.4 + reflectance);
}

double trapezoid(const Surface& surface, const Direction& i, double step_deg) {
  const double step = degrees(step_deg).si();
  CompensatedSum sum;
  for (double theta = 0.0; theta <= 90.0; theta += step_deg) {
    const double share = theta == 90.0 ? 0.5 : 1.0;
    for (double phi = 0.0; phi < 360.0; phi += step_deg) {
      const Direction r = at_deg(theta, phi);
      sum.add(share * surface.eval(i, r).si() * r.mu() * r.sin_theta() * step * step);
    }
  }
  return sum.value();
}

TEST(HardCase, NarrowLobeOnACoarseGrid) {
  // Gaussian slopes of variance 0.001 that mirror all light, at 30 deg.
  const Surface lobe = surface("glint", {{"slope_variance", 0.001}, {"refractive_index", 1e12}});
  const Direction i = at_deg(30);

  const Integral ours = rho_dh(lobe, i, 1e-9);
  const Integral rings = integrate_hemisphere([&](const Direction& r) { return lobe.eval(i, r).si(); }, 1e-6);

  EXPECT_NEAR(ours.value, 1.0, 1e-8);
  EXPECT_LE(ours.error, 1e-9);
  EXPECT_LE(std::abs(rings.value - ours.value), rings.error + ours.error);  // rings say how far they are off
  EXPECT_NEAR(std::abs(trapezoid(lobe, i, 10.0) - 1.0), 0.62, 0.01);
  EXPECT_NEAR(std::abs(by_rings(lobe, i, 8, 16, RingSpacing::Mu) - 1.0), 0.84, 0.01);
}

// f mu at `count` directions, in parts for each of `threads`.
std::vector<Brdf> evaluated_by(std::size_t threads, const std::vector<Direction>& views) {
  std::vector<Brdf> f(views.size());
  const std::size_t share = views.size() / threads + 1;
  std::vector<std::jthread> workers;
  for (std::size_t first = 0; first < views.size(); first += share) {
    const std::size_t count = std::min(share, views.size() - first);
    workers.emplace_back([first, count, &f, &views] {
      wheat().eval_fast(at_deg(30), std::span(views).subspan(first, count), std::span(f).subspan(first, count));
    });
  }
  return f;
}

template <class Number>
Number sum_by_threads(std::size_t threads, const std::vector<Brdf>& f) {
  Number total{};
  const std::size_t share = f.size() / threads + 1;
  for (std::size_t first = 0; first < f.size(); first += share) {
    Number part{};
    for (std::size_t k = first; k < std::min(first + share, f.size()); ++k) part += static_cast<Number>(f[k].si());
    total += part;
  }
  return total;
}

double compensated(const std::vector<Brdf>& f) {
  CompensatedSum sum;
  for (const Brdf value : f) sum.add(value.si());
  return sum.value();
}

TEST(HardCase, SumOfManyReadings) {
  std::vector<Direction> views;
  for (const HemisphereNode& node : gauss_rings(100, 997)) views.push_back(node.direction);
  const std::vector<Brdf> f = evaluated_by(1, views);
  const double truth = compensated(f);

  EXPECT_GT(relative_error(static_cast<double>(sum_by_threads<float>(1, f)), truth), 1e-6);
  std::size_t float_changes = 0;
  std::size_t double_changes = 0;
  for (const std::size_t threads : {2U, 3U, 5U, 8U}) {
    float_changes += sum_by_threads<float>(threads, f) != sum_by_threads<float>(1, f) ? 1U : 0U;
    double_changes += sum_by_threads<double>(threads, f) != sum_by_threads<double>(1, f) ? 1U : 0U;
    EXPECT_EQ(compensated(evaluated_by(threads, views)), truth) << threads;
  }
  EXPECT_GT(float_changes, 0U);
  EXPECT_GT(double_changes, 0U);
}

TEST(HardCase, SumOfTermsOfDifferentSize) {
  CompensatedSum sum;
  double naive = 1e16;
  sum.add(1e16);
  for (int k = 0; k < 1000; ++k) {
    sum.add(1.0);
    naive += 1.0;
  }
  sum.add(-1e16);

  EXPECT_EQ(sum.value(), 1000.0);
  EXPECT_EQ(naive - 1e16, 0.0);
}

}  // namespace
}  // namespace gonio::reflectance
