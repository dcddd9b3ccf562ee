#include "reflectance/fit/fit_scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "reflectance/fit/rank_fits.h"
#include "reflectance/fit/scene_text.h"
#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/measured/scan_quantities.h"
#include "reflectance/surface/surface_sum.h"
#include "tests/reflectance/measured/simulated_scan.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::fit::test {
namespace {

using reflectance::MeasuredScan;
using reflectance::Parameters;
using reflectance::Surface;
using reflectance::test::geometries;
using reflectance::test::perfect_scan;
using reflectance::test::simulated_scan;
using reflectance::test::SimulatedErrors;
using reflectance::test::SimulatedGrid;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

FitModel model(std::string_view text) {
  return FitModel::make(text).value();
}

double value_of(const FitResult& fit, std::string_view name) {
  return fit.find(name)->value;
}

struct KnownSurface {
  const char* model;
  Parameters truth;
};

TEST(FitScan, FindsTheNumbersOfEveryModelFromPerfectReadings) {
  const std::vector<KnownSurface> known{
      {"lambertian", {{"rho", 0.62}}},
      {"minnaert", {{"rho", 0.5}, {"k", 0.5}}},
      {"hapke", {{"omega0", 0.9}}},
      {"hapke_as_printed", {{"omega0", 0.7}}},
      {"hapke_hg", {{"omega0", 0.9}, {"g", -0.3}}},
      {"rpv", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}}},
      {"rpv_brf", {{"rho0", 0.2}, {"k", 1.1}, {"g", 0.1}}},
      {"cox_munk", {{"wind_m_per_s", 10.0}, {"refractive_index", 1.34}}},
      {"cox_munk_smith", {{"wind_m_per_s", 4.0}, {"refractive_index", 1.34}}},
      {"glint_smith", {{"slope_variance", 0.02}, {"refractive_index", 1.7}}},
      {"beckmann", {{"roughness", 0.3}, {"refractive_index", 1.6}}},
      {"ggx", {{"roughness", 0.15}, {"refractive_index", 1.45}}},
      {"water_body", {{"rho_w", 0.05}, {"refractive_index", 1.34}}},
  };
  ASSERT_EQ(known.size(), fit_formulas().size());
  for (const KnownSurface& k : known) {
    SCOPED_TRACE(k.model);
    const MeasuredScan scan = perfect_scan(reflectance::surface(k.model, k.truth), geometries({}));

    const Result<FitResult> fit = fit_scan(scan, model(k.model));

    ASSERT_TRUE(fit) << describe(fit.error());
    for (const reflectance::NamedNumber& p : k.truth) EXPECT_NEAR(value_of(*fit, p.name), p.value, 1e-5) << p.name;
    EXPECT_THAT(fit->undetermined(), ::testing::IsEmpty());
    EXPECT_TRUE(fit->has_converged);
  }
}

TEST(FitScan, FindsAGlossOnAGround) {
  const Surface truth = reflectance::SurfaceSum::make(
                            {{reflectance::surface("lambertian", {{"rho", 0.2}}), 1.0},
                             {reflectance::surface("ggx", {{"roughness", 0.12}, {"refractive_index", 1.5}}), 0.6}})
                            .value();
  SimulatedGrid grid;
  grid.theta_r = {0, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 75};
  const MeasuredScan scan = perfect_scan(truth, geometries(grid));

  const FitResult fit = fit_scan(scan, model("lambertian + ggx")).value();

  EXPECT_NEAR(value_of(fit, "1.rho"), 0.2, 1e-5);
  EXPECT_NEAR(value_of(fit, "2.weight"), 0.6, 1e-4);
  EXPECT_NEAR(value_of(fit, "2.roughness"), 0.12, 1e-5);
}

TEST(FitScan, SaysWhatItIsWorth) {
  const MeasuredScan scan = simulated_scan(reflectance::wheat(), geometries({}), {}, 5);

  const FitResult fit = fit_scan(scan, model("rpv")).value();

  EXPECT_THAT(fit.free_names, ElementsAre("rho0", "k", "g"));
  EXPECT_EQ(fit.degrees_of_freedom, scan.points.size() - 3);
  EXPECT_GT(fit.p_value.value(), 1e-3);
  EXPECT_LT(fit.p_value.value(), 1.0 - 1e-3);
  EXPECT_EQ(fit.residuals.size(), scan.points.size());
  EXPECT_EQ(fit.correlation.size(), 9U);
  EXPECT_NEAR(fit.correlation[0], 1.0, 1e-12);
  EXPECT_NEAR(fit.correlation[1], fit.correlation[3], 1e-12);
  EXPECT_EQ(fit.shifts.size(), 4U);
  EXPECT_GE(fit.agreeing_starts, 1);
  double squares = 0.0;
  for (const FitResidual& r : fit.residuals) squares += r.z * r.z;
  for (const SharedShift& s : fit.shifts) squares += s.standard_deviations * s.standard_deviations;
  EXPECT_NEAR(squares / fit.chi2, 1.0, 1e-9);
}

TEST(FitScan, KnowsThatTheCertificateLiftsAllReadingsAlike) {
  SimulatedErrors errors{.noise = 1e-4, .least_noise = 0.0, .certificate = 0.01, .limb = 0.0, .zero_theta_r = 0.0};
  const MeasuredScan scan =
      simulated_scan(reflectance::surface("lambertian", {{"rho", 0.5}}), geometries({}), errors, 9);

  const FitResult fit = fit_scan(scan, model("lambertian")).value();

  EXPECT_NEAR(fit.find("rho")->u / value_of(fit, "rho"), 0.01, 1e-4);
}

// With shared effects stated from the readings themselves a plain fit of 1000 readings is 1000 x 0.01^2 low.
TEST(FitScan, IsNotDrawnDownByReadingsThatAreLowByChance) {
  SimulatedErrors errors{
      .noise = 0.01, .least_noise = 0.0, .certificate = 0.01, .limb = 0.0, .zero_theta_r = 0.0, .background = 0.0};
  SimulatedGrid fine;
  fine.phi_step = 5;
  double mean = 0.0;
  constexpr int kScans = 20;
  for (std::uint64_t seed = 1; seed <= kScans; ++seed) {
    MeasuredScan scan =
        simulated_scan(reflectance::surface("lambertian", {{"rho", 0.5}}), geometries(fine), errors, seed);
    mean += value_of(fit_scan(scan, model("lambertian")).value(), "rho") / kScans;
  }

  EXPECT_NEAR(mean, 0.5, 3.0 * 0.005 / std::sqrt(kScans));
}

TEST(FitScan, MovesAsItsDependenceOnTheReadingsSays) {
  SimulatedErrors errors;
  errors.zero_theta_r = errors.background = 0.0;
  MeasuredScan scan = simulated_scan(reflectance::wheat(), geometries({}), errors, 5);
  const FitResult before = fit_scan(scan, model("rpv")).value();

  const std::size_t point = 40;
  const double step = 0.2 * scan.points[point].u_random.si();
  const double ratio = 1.0 + step / scan.points[point].value.si();
  scan.points[point].value += per_steradian(step);
  for (reflectance::SharedEffect& e : scan.points[point].shared) e.per_sd = ratio * e.per_sd;  // stated in per cent
  const FitResult after = fit_scan(scan, model("rpv")).value();

  for (const char* name : {"rho0", "k", "g"}) {
    const double told = before.find(name)->per_reading[point] * step;
    EXPECT_NEAR(value_of(after, name) - value_of(before, name), told, 0.05 * std::abs(told) + 1e-9) << name;
  }
}

TEST(FitScan, SaysWhatTheDataDoNotDetermine) {
  // Under one incidence and in one view, any of the three numbers can make the value.
  const MeasuredScan one = perfect_scan(reflectance::wheat(), {reflectance::geometry(30, 40, 90)}, 1e-3);
  const FitResult fit = fit_scan(one, model("rpv")).value();

  EXPECT_GE(fit.undetermined().size(), 2U);
  EXPECT_EQ(fit.p_value, std::nullopt);
  EXPECT_EQ(fit.degrees_of_freedom, 0U);
}

TEST(FitScan, SaysWhenANumberIsAtItsBound) {
  FitModel bounded = model("minnaert");
  ASSERT_TRUE(bounded.change("k", {.start = 0.1, .least = 0.0, .most = 0.2}));
  const MeasuredScan scan =
      perfect_scan(reflectance::surface("minnaert", {{"rho", 0.5}, {"k", 0.5}}), geometries({}), 1e-3);

  const FitResult fit = fit_scan(scan, bounded).value();

  EXPECT_TRUE(fit.find("k")->is_at_bound);
  EXPECT_NEAR(value_of(fit, "k"), 0.2, 1e-6);
  EXPECT_LT(fit.p_value.value(), 1e-6);
}

TEST(FitScan, TakesItsUncertaintyFromTheScatterWhenTheFileHasNone) {
  MeasuredScan scan = simulated_scan(reflectance::wheat(), geometries({}), {}, 5);
  for (reflectance::MeasuredPoint& p : scan.points) {
    p.u_random = {};
    p.shared.clear();
  }

  EXPECT_THAT(fit_scan(scan, model("rpv")).error().seen, HasSubstr("point 0: u_random 0"));
  const FitResult fit = fit_scan(scan, model("rpv"), {.weights = FitWeights::Even}).value();
  EXPECT_NEAR(value_of(fit, "k"), 0.851, 0.03);
  EXPECT_GT(fit.find("k")->u, 1e-4);
  EXPECT_LT(fit.find("k")->u, 1e-2);
  EXPECT_EQ(fit.p_value, std::nullopt);
}

TEST(FitScan, GivesTheSameBitsForTheSameSeed) {
  const MeasuredScan scan = simulated_scan(reflectance::wheat(), geometries({}), {}, 5);

  const FitResult a = fit_scan(scan, model("rpv")).value();
  const FitResult b = fit_scan(scan, model("rpv")).value();

  EXPECT_EQ(value_of(a, "k"), value_of(b, "k"));
  EXPECT_EQ(a.find("g")->u, b.find("g")->u);
}

TEST(FitScan, HasAWordForBadInput) {
  MeasuredScan flagged = perfect_scan(reflectance::wheat(), geometries({}));
  for (reflectance::MeasuredPoint& p : flagged.points) p.is_flagged = true;
  FitModel nothing_free = model("lambertian");
  ASSERT_TRUE(nothing_free.change("rho", {.is_fixed = true}));
  const MeasuredScan scan = perfect_scan(reflectance::wheat(), geometries({}));

  EXPECT_THAT(fit_scan(MeasuredScan{}, model("rpv")).error().seen, HasSubstr("no points"));
  EXPECT_THAT(fit_scan(flagged, model("rpv")).error().seen, HasSubstr("flagged"));
  EXPECT_THAT(fit_scan(scan, nothing_free).error().seen, HasSubstr("no free number"));
  EXPECT_THAT(fit_scan(scan, model("rpv"), {.starts = 0}).error().seen, HasSubstr("0 starts"));
}

TEST(RankFits, PrefersTheTruthAndNotTheModelWithMoreNumbers) {
  const MeasuredScan scan =
      simulated_scan(reflectance::surface("minnaert", {{"rho", 0.5}, {"k", 0.3}}), geometries({}), {}, 3);
  const std::vector<FitModel> models{model("lambertian"), model("hapke"), model("minnaert"), model("minnaert + rpv")};

  const std::vector<FitResult> fits = fit_models(scan, models).value();
  const std::vector<RankedFit> ranks = rank_fits(fits).value();

  EXPECT_EQ(ranks.front().model, "minnaert");
  EXPECT_LT(ranks.back().weight, 1e-6);
  double sum = 0.0;
  for (const RankedFit& rank : ranks) sum += rank.weight;
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_FALSE(rank_fits({}));
}

TEST(CapOfFits, GoesOnBeyondTheArmAndMovesWithTheReadings) {
  SimulatedGrid grid;
  grid.theta_r = {0, 15, 30, 45, 60};
  const MeasuredScan scan = simulated_scan(reflectance::wheat(), geometries(grid), {}, 8);
  const std::vector<FitModel> models{model("rpv"), model("minnaert")};
  const std::vector<FitResult> fits = fit_models(scan, models).value();

  const auto i = reflectance::Direction::from_angles(degrees(30.0), {});
  const reflectance::ScanQuantity rho =
      reflectance::ScanQuantities::make(scan, {}, cap_of(fits).value()).value().rho_dh(i).value();

  const double truth = reflectance::rho_dh(reflectance::wheat(), i).value;
  EXPECT_NEAR(rho.value, truth, 3.0 * rho.u);
  EXPECT_LT(rho.u / truth, 0.02);
  EXPECT_GT(rho.modelled_share, 0.15);
}

// Surfaces that are none of the models tried: what stands beyond the arm is wrong by more than noise and fit tell.
TEST(CapOfFits, OfModelsThatDoNotFitHoldsTheTruthWithinU) {
  const auto of = [](std::vector<const char*> names) {
    std::vector<FitModel> models;
    for (const char* name : names) models.push_back(model(name));
    return models;
  };
  const Surface minnaert = reflectance::surface("minnaert", {{"rho", 0.5}, {"k", 0.3}});
  const Surface sum = reflectance::SurfaceSum::make({{reflectance::wheat(), 0.8}, {minnaert, 0.6}}).value();
  const auto glossy = [](double roughness) {  // facets with another distribution than the fit's
    const Surface facets = reflectance::surface("beckmann", {{"roughness", roughness}, {"refractive_index", 1.5}});
    return reflectance::SurfaceSum::make({{reflectance::surface("lambertian", {{"rho", 0.3}}), 1.0}, {facets, 1.0}})
        .value();
  };
  const std::vector<FitModel> usual = of({"lambertian", "minnaert", "rpv", "lambertian + ggx"});
  struct Row {
    const char* name;
    Surface truth;
    std::vector<FitModel> models;
  };
  const std::vector<Row> rows{
      {"wheat", reflectance::wheat(), of({"lambertian", "minnaert", "lambertian + ggx"})},
      {"Minnaert", minnaert, of({"lambertian", "rpv", "lambertian + ggx"})},
      {"a sum", sum, usual},
      {"dark Hapke", reflectance::surface("hapke", {{"omega0", 0.6}}), usual},
      {"white Hapke", reflectance::surface("hapke", {{"omega0", 0.99}}), usual},
      {"sharp gloss", glossy(0.06), usual},
      {"gloss", glossy(0.12), usual},
      {"dull gloss", glossy(0.5), usual},
  };
  double worst_without = 0.0;
  double squares = 0.0;
  int count = 0;
  for (const Row& row : rows) {
    for (const double reach_deg : {60.0, 75.0}) {
      SCOPED_TRACE(testing::Message() << row.name << ", to theta_r " << reach_deg);
      SimulatedGrid grid{.phi_step = 15.0};
      if (reach_deg < 75.0) grid.theta_r.pop_back();
      const MeasuredScan scan = simulated_scan(row.truth, geometries(grid), {}, 1);
      const std::vector<FitResult> fits = fit_models(scan, row.models).value();
      const Surface best = fits[rank_fits(fits).value().front().fit].surface;
      const auto quantities =
          reflectance::ScanQuantities::make(scan, {.table = {}, .fitted = best}, cap_of(fits).value()).value();
      for (const double theta_i : {0.0, 30.0, 60.0}) {
        const auto i = reflectance::Direction::from_angles(degrees(theta_i), {});
        const reflectance::ScanQuantity rho = quantities.rho_dh(i).value();
        const double off = rho.value - reflectance::rho_dh(row.truth, i).value;
        EXPECT_LT(std::abs(off), rho.expanded) << theta_i << ": " << rho.value;
        EXPECT_LT(rho.u_modelled, 0.15 * rho.value);
        squares += off * off / (rho.u * rho.u);
        worst_without =
            std::max(worst_without, std::abs(off) / std::sqrt(rho.u * rho.u - rho.u_modelled * rho.u_modelled));
        ++count;
      }
    }
  }
  EXPECT_GT(worst_without, 5.0) << "the rows are no hard ones";
  EXPECT_GT(std::sqrt(squares / count), 0.3)
      << "U is too wide";  // they are no draws of one distribution: some are lucky
}

TEST(SceneText, WritesAModelWithEveryDigitAndRefusesATable) {
  const std::string text = scene_sample(reflectance::wheat()).value();
  const Surface sum = reflectance::SurfaceSum::make({{reflectance::wheat(), 0.25}, {reflectance::sea(), 2.0}}).value();

  EXPECT_EQ(text, "[sample]\nmodel = \"rpv\"\nrho0 = 0.133\nk = 0.851\ng = -0.114\n");
  EXPECT_THAT(scene_sample(sum).value(), HasSubstr("[[sample.terms]]\nweight = 0.25\nmodel = \"rpv\""));
  const MeasuredScan scan = perfect_scan(reflectance::wheat(), geometries({}));
  const Surface table = reflectance::interpolate_scan(scan).value().best();
  EXPECT_THAT(scene_sample(table).error().seen, HasSubstr("interpolated_scan"));
}

}  // namespace
}  // namespace gonio::fit::test
