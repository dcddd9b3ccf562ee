// Scans by the whole chain: simulated readings at reading level with every shared error drawn anew, calibrated by what
// the daemon is told, fitted by the covariance that came out; and how often the stated intervals of a model's numbers
// and of rho_dh hold the truth.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "calibration/calibrate.h"
#include "reflectance/fit/fit_scan.h"
#include "reflectance/fit/rank_fits.h"
#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/measured/scan_quantities.h"
#include "reflectance/surface/surface_sum.h"
#include "sim/devices/reading_level.h"
#include "tests/coverage/coverage_scene.h"
#include "tests/support/interval_tally.h"

namespace gonio::coverage {
namespace {

using reflectance::MeasuredScan;

const UtcTime kDay{std::chrono::sys_days{std::chrono::year{2026} / 3 / 1}};
constexpr std::uint64_t kRepetitions = 400;

MeasuredScan measured_scan_of(const calibration::CalibratedScan& calibrated) {
  MeasuredScan scan{.name = "calibrated"};
  for (const calibration::Component& c : calibrated.components) {
    scan.components.push_back({.name = c.name, .source = "", .is_pattern_known = c.is_pattern_known});
  }
  for (const calibration::CalibratedPoint& p : calibrated.points) {
    reflectance::MeasuredPoint& point = scan.points.emplace_back();
    point.geometry = p.geometry;
    point.value = p.value;
    point.u_random = p.budget.u_random;
    for (const calibration::BudgetTerm& term : p.budget.shared) point.shared.push_back({term.component, term.per_sd});
  }
  return scan;
}

// The scans of one scene, one a seed.
class Scans {
 public:
  explicit Scans(const CoverageScene& scene) : prepared_(prepare(scene).value()), standard_(prepared_.reference) {}

  [[nodiscard]] MeasuredScan measure(std::uint64_t seed) const {
    sim::Scene scene = prepared_.base;
    scene.seed = seed;
    const sim::ReadingLevel instrument(std::move(scene));
    ShortScan short_scan(prepared_.scene.plan, prepared_.points);
    const calibration::ScanReadings readings = short_scan.measure(instrument);
    return measured_scan_of(calibration::calibrate(readings, prepared_.told, standard_, kDay, {.threads = 1}).value());
  }
  [[nodiscard]] reflectance::Surface truth() const {
    if (prepared_.base.sample.size() == 1) return prepared_.base.sample[0].surface;
    return reflectance::SurfaceSum::make(prepared_.base.sample).value();
  }

 private:
  PreparedScene prepared_;
  calibration::ReferenceStandard standard_;
};

struct Case {
  CoverageScene scene;
  const char* model;
  std::vector<reflectance::NamedNumber> truth;  ///< of the free numbers
  std::vector<const char*> rivals;              ///< other models that the cap might be
};

void expect_chain_holds(const Case& c) {
  const Scans scans(c.scene);
  std::vector<fit::FitModel> models{fit::FitModel::make(c.model).value()};
  for (const char* rival : c.rivals) models.push_back(fit::FitModel::make(rival).value());
  const auto i = reflectance::Direction::from_angles(degrees(30.0), {});
  double chi2 = 0.0;
  double freedom = 0.0;
  std::vector<test::IntervalTally> tallies;
  for (const reflectance::NamedNumber& p : c.truth) tallies.emplace_back(p.name, p.value);
  test::IntervalTally rho("rho_dh(30 deg)", reflectance::rho_dh(scans.truth(), i).value);
  for (std::uint64_t seed = c.scene.first_seed; seed < c.scene.first_seed + kRepetitions; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const MeasuredScan scan = scans.measure(seed);
    const std::vector<fit::FitResult> fits = fit::fit_models(scan, models, {.starts = 2}).value();
    chi2 += fits.front().chi2;
    freedom += static_cast<double>(fits.front().degrees_of_freedom);
    for (std::size_t k = 0; k < tallies.size(); ++k) {
      const fit::FittedParameter& p = *fits.front().find(c.truth[k].name);
      tallies[k].add(p.value, p.U);
    }
    const auto quantities = reflectance::ScanQuantities::make(scan, {.table = {}, .fitted = fits.front().surface},
                                                              fit::cap_of(fits).value());
    const reflectance::ScanQuantity q = quantities.value().rho_dh(i).value();
    rho.add(q.value, q.expanded);
  }
  std::printf("chi-square by degrees of freedom %.3f\n", chi2 / freedom);
  for (const test::IntervalTally& tally : tallies) tally.expect_true();
  rho.expect_true();
}

TEST(FitCampaign, HoldsForTheWheatAndItsRhoDh) {
  expect_chain_holds({.scene = {.name = "wheat", .file = "wheat", .first_seed = 7001},
                      .model = "rpv",
                      .truth = {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}},
                      .rivals = {"minnaert"}});
}

TEST(FitCampaign, HoldsForTheSingleScatteringAlbedoAndRhoDhOfItsMedium) {
  expect_chain_holds({.scene = {.name = "hapke", .file = "hapke", .first_seed = 8001},
                      .model = "hapke",
                      .truth = {{"omega0", 0.9}},
                      .rivals = {"minnaert"}});
}

// The ground below the glitter hangs on the slopes along phi, of azimuths 20 to 45 deg apart.
TEST(FitCampaign, HoldsForTheWindOverTheSeaAndForTheGroundBelow) {
  CoverageScene sea{.name = "sea", .file = "glint", .first_seed = 9001};
  sea.plan.theta_r_deg = {0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0};
  sea.plan.phi_r_deg = {90.0, 135.0, 160.0, 180.0};
  expect_chain_holds({.scene = sea,
                      .model = "cox_munk + lambertian",
                      .truth = {{"1.wind_m_per_s", 10.0}, {"2.rho", 0.02}},
                      .rivals = {}});
}

}  // namespace
}  // namespace gonio::coverage
