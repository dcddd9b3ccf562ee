// Whether what a fit and an integral say of themselves is true: scans drawn anew, every shared error too, and counted
// how often the 95.45 % intervals hold the truth.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "reflectance/fit/fit_scan.h"
#include "reflectance/fit/rank_fits.h"
#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/measured/scan_quantities.h"
#include "tests/reflectance/measured/simulated_scan.h"
#include "tests/reflectance/surfaces.h"
#include "tests/support/interval_tally.h"

namespace gonio::fit::test {
namespace {

using reflectance::MeasuredScan;
using reflectance::Surface;
using reflectance::test::geometries;
using reflectance::test::simulated_scan;
using reflectance::test::SimulatedErrors;
using reflectance::test::SimulatedGrid;

constexpr int kRepetitions = 400;

// Fits the model to scans of its own kind and counts each number of `truth`.
void expect_coverage(const char* model_name, const reflectance::Parameters& truth, const SimulatedErrors& errors) {
  const Surface surface = reflectance::surface(model_name, truth);
  const FitModel model = FitModel::make(model_name).value();
  std::vector<gonio::test::IntervalTally> coverages;
  for (const reflectance::NamedNumber& p : truth) {
    coverages.emplace_back(std::string(model_name) + " " + p.name, p.value);
  }
  double chi2 = 0.0;
  double freedom = 0.0;
  for (std::uint64_t seed = 1; seed <= kRepetitions; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const MeasuredScan scan = simulated_scan(surface, geometries({}), errors, seed);
    const FitResult fit = fit_scan(scan, model, {.starts = 2}).value();
    chi2 += fit.chi2;
    freedom += static_cast<double>(fit.degrees_of_freedom);
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const FittedParameter& p = *fit.find(truth[k].name);
      if (!p.is_fixed) coverages[k].add(p.value, p.U);
    }
  }
  EXPECT_NEAR(chi2 / freedom, 1.0, 0.02);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    if (truth[k].name != "refractive_index") coverages[k].expect_true();
  }
}

TEST(FitCoverage, HoldsForTheWheatsThreeNumbers) {
  expect_coverage("rpv", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}}, {});
}

TEST(FitCoverage, HoldsForTheSingleScatteringAlbedo) {
  expect_coverage("hapke", {{"omega0", 0.9}}, {});
}

TEST(FitCoverage, HoldsForTheWindOverTheSea) {
  expect_coverage("cox_munk", {{"wind_m_per_s", 10.0}, {"refractive_index", 1.34}}, {});
}

// rho_dh of the readings, with the fit in the part that the arm does not reach.
TEST(ScanCoverage, HoldsForRhoDhOfTheWheat) {
  const std::vector<FitModel> models{FitModel::make("rpv").value(), FitModel::make("minnaert").value(),
                                     FitModel::make("lambertian").value()};
  const SimulatedGrid grid{.theta_i = {0, 15, 30, 45, 60}, .theta_r = {0, 10, 20, 30, 40, 50, 60, 70, 80}};
  const auto i = reflectance::Direction::from_angles(degrees(30.0), {});
  gonio::test::IntervalTally coverage("rho_dh(30 deg) of wheat", reflectance::rho_dh(reflectance::wheat(), i).value);
  for (std::uint64_t seed = 1; seed <= kRepetitions; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const MeasuredScan scan = simulated_scan(reflectance::wheat(), geometries(grid), {}, seed);
    const std::vector<FitResult> fits = fit_models(scan, models, {.starts = 1}).value();
    const auto quantities =
        reflectance::ScanQuantities::make(scan, {.table = {}, .fitted = fits.front().surface}, cap_of(fits).value());
    const reflectance::ScanQuantity rho = quantities.value().rho_dh(i).value();
    coverage.add(rho.value, rho.expanded);
  }
  coverage.expect_true();
}

}  // namespace
}  // namespace gonio::fit::test
