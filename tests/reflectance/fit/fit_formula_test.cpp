#include "reflectance/fit/fit_formula.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reflectance/surface/make_surface.h"
#include "tests/reflectance/generated.h"

namespace gonio::fit::test {
namespace {

using reflectance::Direction;
using reflectance::GeneratedDirections;
using reflectance::Parameters;

constexpr std::uint64_t kSeed = 20261101;

double value_of(const FitFormula& formula, const PairTerms& pair, const std::vector<double>& x) {
  return formula.value(pair, x).v;
}

std::vector<double> starts_of(const FitFormula& formula) {
  std::vector<double> x;
  for (const FormulaParameter& p : formula.parameters) x.push_back(p.start);
  return x;
}

Direction off_the_horizon(GeneratedDirections& directions) {
  return Direction::from_angles(radians(1.5 * directions.unit()), radians(6.0 * directions.unit()));
}

TEST(FitFormulas, AreTheSurfacesOwn) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  for (const FitFormula& formula : fit_formulas()) {
    SCOPED_TRACE(formula.model);
    Parameters parameters;
    for (const FormulaParameter& p : formula.parameters) parameters.push_back({std::string(p.name), p.start});
    const reflectance::Surface surface = reflectance::make_surface(formula.model, parameters).value();
    GeneratedDirections directions(kSeed);
    for (int k = 0; k < 2000; ++k) {
      const Direction i = off_the_horizon(directions);
      const Direction r = off_the_horizon(directions);
      const double f = surface.eval(i, r).si();
      // Rough facets far from their lobe: the exponent has 700 times the rounding of its argument.
      EXPECT_NEAR(value_of(formula, pair_terms(i, r), starts_of(formula)), f, 1e-11 * f);
    }
  }
}

TEST(FitFormulas, HaveTheSlopesThatTheirValuesHave) {
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  for (const FitFormula& formula : fit_formulas()) {
    for (std::size_t k = 0; k < formula.parameters.size(); ++k) {
      SCOPED_TRACE(std::string(formula.model) + "." + std::string(formula.parameters[k].name));
      GeneratedDirections directions(kSeed);
      for (int draw = 0; draw < 300; ++draw) {
        const PairTerms pair = pair_terms(off_the_horizon(directions), off_the_horizon(directions));
        const double step = 1e-5 * (formula.parameters[k].most - formula.parameters[k].least);
        std::vector<double> low = starts_of(formula);
        std::vector<double> high = low;
        low[k] -= step;
        high[k] += step;
        const double f = value_of(formula, pair, starts_of(formula));
        const double slope = (value_of(formula, pair, high) - value_of(formula, pair, low)) / (2.0 * step);
        const double found = formula.value(pair, starts_of(formula)).d[k];
        const double range = formula.parameters[k].most - formula.parameters[k].least;
        // In the farthest tails the difference of values is too coarse to tell a slope.
        constexpr double kNothing = 1e-30;
        EXPECT_NEAR(found * range, slope * range, kNothing + 2e-4 * (std::abs(found * range) + std::abs(f)));
      }
    }
  }
}

TEST(FitFormulas, StartWithinTheirBoundsWhichAreWithinTheModels) {
  for (const FitFormula& formula : fit_formulas()) {
    for (const FormulaParameter& p : formula.parameters) {
      SCOPED_TRACE(std::string(formula.model) + "." + std::string(p.name));
      EXPECT_GT(p.start, p.least);
      EXPECT_LT(p.start, p.most);
      for (const double end : {p.least, p.most}) {
        Parameters parameters;
        for (const FormulaParameter& q : formula.parameters) {
          parameters.push_back({std::string(q.name), q.name == p.name ? end : q.start});
        }
        EXPECT_TRUE(reflectance::make_surface(formula.model, parameters));
      }
    }
  }
}

}  // namespace
}  // namespace gonio::fit::test
