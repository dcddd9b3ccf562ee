#include "reflectance/surface/chandrasekhar_h.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>

#include "reflectance/integral/gauss_legendre.h"
#include "tests/reflectance/printed.h"

namespace gonio::reflectance {
namespace {

// By quadrature of the closed form with 30 digits, at mu = 1e-12, 0.001, 0.1, 0.5, 0.9 and 1.
constexpr double kMus[] = {1e-12, 0.001, 0.1, 0.5, 0.9, 1.0};

void expect_h(double one_minus_omega0, const Printed (&expected)[6]) {
  const ChandrasekharH h(one_minus_omega0);
  for (std::size_t k = 0; k < std::size(kMus); ++k) {
    EXPECT_TRUE(agrees(std::exp(h.log(kMus[k])), expected[k], 2e-15)) << "mu " << kMus[k];
  }
}

TEST(ChandrasekharH, MatchesTheReference) {
  expect_h(0.5, {"1.00000000000701983", "1.00184080262943946", "1.07236876202990913", "1.18773513267043055",
                 "1.24169373162801431", "1.2512595633832226"});
  expect_h(0.1, {"1.00000000001298767", "1.00366886994451083", "1.17214305351645303", "1.55603380202136265",
                 "1.80078735805660105", "1.85009851676981233"});
}

TEST(ChandrasekharH, ReachesTheLossFreeMedium) {
  const ChandrasekharH h(0.0);
  EXPECT_TRUE(agrees(std::exp(h.log(0.1)), "1.2473504424944359", 2e-15));
  EXPECT_TRUE(agrees(std::exp(h.log(0.5)), "2.01277876999718075", 2e-15));
  EXPECT_TRUE(agrees(std::exp(h.log(1.0)), "2.90781052907860572", 2e-15));
  // H(mu) = 1 at omega0 = 0.
  EXPECT_EQ(ChandrasekharH(1.0).log(0.7), 0.0);
}

TEST(ChandrasekharH, SolvesItsIntegralEquation) {
  // H(mu) (1 - (omega0/2) mu integral of H(u)/(mu + u) du) = 1, with u = v^2 against the logarithm at 0.
  const UnitRule rule = gauss_legendre(200);
  for (const double omega0 : {0.3, 0.9, 0.999999, 1.0}) {
    const ChandrasekharH h(1.0 - omega0);
    for (const double mu : {0.01, 0.3, 0.7, 1.0}) {
      double integral = 0.0;
      for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
        const double u = rule.nodes[k] * rule.nodes[k];
        integral += 2.0 * rule.nodes[k] * rule.weights[k] * std::exp(h.log(u)) / (mu + u);
      }
      EXPECT_NEAR(std::exp(h.log(mu)) * (1.0 - 0.5 * omega0 * mu * integral), 1.0, 1e-10) << omega0 << " " << mu;
    }
  }
}

TEST(ChandrasekharH, HasNoStepWhereItsPiecesMeet) {
  const ChandrasekharH h(0.1);
  for (const double edge : {0.5, 0.25, 0x1p-10, 0x1p-30}) {
    EXPECT_NEAR(h.log(edge), h.log(std::nextafter(edge, 0.0)), 2e-15) << edge;
  }
}

}  // namespace
}  // namespace gonio::reflectance
