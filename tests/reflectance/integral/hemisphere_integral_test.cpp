#include "reflectance/integral/hemisphere_integral.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reflectance/integral/gauss_legendre.h"
#include "reflectance/integral/tanh_sinh.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(GaussLegendre, IntegratesPolynomialsUpToTwiceItsSizeLessOne) {
  for (const int size : {1, 2, 5, 16, 30, 65, 256}) {
    const UnitRule rule = gauss_legendre(size);
    for (const int degree : {0, 1, size, 2 * size - 1}) {
      double sum = 0.0;
      for (std::size_t k = 0; k < rule.nodes.size(); ++k) sum += rule.weights[k] * std::pow(rule.nodes[k], degree);
      EXPECT_NEAR(sum * (degree + 1.0), 1.0, 2e-14) << size << " nodes, degree " << degree;
    }
  }
}

TEST(GaussLegendre, HasTheKnownNodes) {
  const UnitRule rule = gauss_legendre(3);

  // 1/2 -+ sqrt(3/5)/2 and weights 5/18, 8/18.
  EXPECT_DOUBLE_EQ(rule.nodes[0], 0.5 - 0.5 * std::sqrt(0.6));
  EXPECT_DOUBLE_EQ(rule.nodes[1], 0.5);
  EXPECT_DOUBLE_EQ(rule.weights[0], 5.0 / 18.0);
  EXPECT_DOUBLE_EQ(rule.weights[1], 8.0 / 18.0);
}

TEST(TanhSinh, TakesSingularEndsInItsStride) {
  double root = 0.0;
  double logarithm = 0.0;
  for (const EndNode& node : tanh_sinh(5)) {
    root += node.weight / std::sqrt(node.x);
    logarithm += node.weight * std::log(node.rest);
  }
  EXPECT_NEAR(root, 2.0, 1e-11);
  EXPECT_NEAR(logarithm, -1.0, 1e-15);
}

TEST(GaussRings, ShareTheProjectedSolidAngleOfTheHemisphere) {
  for (const RingSpacing spacing : {RingSpacing::Mu, RingSpacing::SqrtMu}) {
    double total = 0.0;
    for (const HemisphereNode& node : gauss_rings(8, 5, spacing)) total += node.weight_sr;
    EXPECT_NEAR(total, kPi, 1e-14);
  }
}

TEST(GaussRings, RunFromTheHorizonUpwardsWithPhiFastest) {
  const std::vector<HemisphereNode> nodes = gauss_rings(4, 6);

  ASSERT_EQ(nodes.size(), 24u);
  EXPECT_EQ(nodes[0].direction.mu(), nodes[5].direction.mu());
  EXPECT_LT(nodes[5].direction.mu(), nodes[6].direction.mu());
  EXPECT_NEAR(in_degrees(nodes[0].direction.phi()), 30.0, 1e-12);
  EXPECT_NEAR(in_degrees(nodes[1].direction.phi()), 90.0, 1e-12);
}

TEST(IntegrateHemisphere, OfOneIsPi) {
  const Integral one = integrate_hemisphere([](const Direction&) { return 1.0; }, 1e-14);

  EXPECT_NEAR(one.value, kPi, one.error);
  EXPECT_LT(one.error, 1e-14 * kPi);
  EXPECT_EQ(one.evaluations, 8u * 16u + 16u * 32u);
}

TEST(IntegrateHemisphere, KnowsHowWrongItIs) {
  // integral of mu^p mu dOmega = 2 pi / (p + 2): the root at the horizon makes the rings converge slowly.
  const Integral root = integrate_hemisphere([](const Direction& r) { return std::sqrt(r.mu()); }, 1e-8);

  EXPECT_NEAR(root.value, 2.0 * kPi / 2.5, root.error);
  EXPECT_LT(root.error, 1e-8 * root.value);
}

TEST(IntegrateHemisphere, KeepsASignAndReportsAKinkThatItCannotResolve) {
  const Integral odd = integrate_hemisphere([](const Direction& r) { return std::cos(r.phi().si()); }, 1e-10);
  EXPECT_NEAR(odd.value, 0.0, 1e-14);

  // A cap of 0.2 rad about the normal, cut off sharply: pi sin^2(0.2).
  const Integral cap =
      integrate_hemisphere([](const Direction& r) { return r.theta() < radians(0.2) ? 1.0 : 0.0; }, 1e-10);
  EXPECT_GT(cap.error, 1e-10 * cap.value);
  EXPECT_NEAR(cap.value, kPi * std::sin(0.2) * std::sin(0.2), 3.0 * cap.error);
}

TEST(IntegrateHemisphere, NormalisesAShapeByTheGeometryOfItsCertificate) {
  // s = c (1 + mu^2): its 8/h factor integral s mu dOmega / pi = 1.5 c must become 1.
  const auto shape = [](const Direction& r) { return 0.7 * (1.0 + r.mu() * r.mu()); };

  const double factor = integrate_hemisphere(shape, 1e-12).value / kPi;

  EXPECT_NEAR(factor, 1.05, 1e-14);
}

}  // namespace
}  // namespace gonio::reflectance
