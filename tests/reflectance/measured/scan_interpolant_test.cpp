#include "reflectance/measured/scan_interpolant.h"

#include <gtest/gtest.h>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/measured/interpolate_scan.h"
#include "reflectance/sampling/make_sampler.h"
#include "reflectance/surface/surface_sum.h"
#include "tests/reflectance/generated.h"
#include "tests/reflectance/measured/simulated_scan.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance::test {
namespace {

const SimulatedGrid kTenDegrees{.theta_i = {0, 20, 40, 60}, .theta_r = {0, 10, 20, 30, 40, 50, 60, 70}, .phi_step = 15};

Surface glossy() {
  return SurfaceSum::make({{surface("lambertian", {{"rho", 0.2}}), 1.0},
                           {surface("ggx", {{"roughness", 0.15}, {"refractive_index", 1.5}}), 1.0}})
      .value();
}

double rms_between(const Surface& a, const Surface& b) {
  double squares = 0.0;
  double size = 0.0;
  for (double theta = 2.0; theta < 69.0; theta += 3.0) {
    for (double phi = 1.0; phi < 180.0; phi += 7.0) {
      const Geometry g = geometry(40, theta, phi);
      const double off = a.eval(g).si() - b.eval(g).si();
      squares += off * off;
      size += b.eval(g).si() * b.eval(g).si();
    }
  }
  return std::sqrt(squares / size);
}

TEST(ScanInterpolant, GivesEachReadingBack) {
  const MeasuredScan scan = simulated_scan(wheat(), geometries(kTenDegrees), {}, 3);
  const Interpolation interpolation = interpolate_scan(scan).value();

  for (const MeasuredPoint& p : scan.points) {
    if (p.geometry.theta_i == Angle{}) continue;  // there readings of all azimuths are one
    EXPECT_NEAR(Surface(interpolation.best()).eval(p.geometry) / p.value, 1.0, 1e-9);
  }
}

TEST(ScanInterpolant, SharesAddUpToTheValue) {
  const MeasuredScan scan = simulated_scan(wheat(), geometries(kTenDegrees), {}, 3);
  constexpr std::uint64_t kSeed = 5;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  GeneratedDirections directions(kSeed);

  const Interpolation interpolation = interpolate_scan(scan).value();
  for (const InterpolationCandidate& candidate : interpolation.candidates) {
    for (int k = 0; k < 500; ++k) {
      const Direction i = directions.next();
      const Direction r = directions.next();
      std::vector<ReadingShare> shares;
      const bool is_covered = candidate.interpolant.shares(i, r, shares);
      double sum = 0.0;
      for (const ReadingShare& share : shares) sum += share.weight * scan.points[share.reading].value.si();

      EXPECT_NEAR(sum / candidate.interpolant.eval(i, r).si(), 1.0, 1e-9) << candidate.interpolant.guide().name;
      EXPECT_EQ(is_covered, candidate.interpolant.covers(i, r));
    }
  }
}

TEST(ScanInterpolant, SharesAddUpWhereTheNormalWasNotMeasured) {
  SimulatedGrid grid = kTenDegrees;
  grid.theta_i = {20, 40};
  const MeasuredScan scan = simulated_scan(wheat(), geometries(grid), {}, 3);
  const ScanInterpolant interpolant = interpolate_scan(scan).value().best();

  for (const double theta_i : {0.0, 7.0}) {
    const Direction i = Direction::from_angles(degrees(theta_i), Angle{});
    const Direction r = Direction::from_angles(degrees(33.0), degrees(50.0));
    std::vector<ReadingShare> shares;
    interpolant.shares(i, r, shares);
    double sum = 0.0;
    for (const ReadingShare& share : shares) sum += share.weight * scan.points[share.reading].value.si();
    EXPECT_NEAR(sum / interpolant.eval(i, r).si(), 1.0, 1e-9);
  }
}

TEST(InterpolateScan, ChoosesTheMatteFormForACanopyAndTheLobeForAGloss) {
  const Interpolation canopy = interpolate_scan(perfect_scan(wheat(), geometries(kTenDegrees))).value();
  const Interpolation gloss = interpolate_scan(perfect_scan(glossy(), geometries(kTenDegrees))).value();

  EXPECT_EQ(canopy.best().guide().name, "matte");
  EXPECT_EQ(gloss.best().guide().name, "lobe");
}

TEST(InterpolateScan, IsSeveralTimesCloserWithTheGuideThanWithout) {
  for (const Surface& truth : {wheat(), glossy()}) {
    SCOPED_TRACE(truth.model());
    const MeasuredScan scan = perfect_scan(truth, geometries(kTenDegrees));
    const Interpolation interpolation = interpolate_scan(scan).value();
    const Surface flat =
        ScanInterpolant::make(scan, {.name = "flat", .surface = surface("lambertian", {{"rho", 1.0}})}).value();

    const double guided = rms_between(Surface(interpolation.best()), truth);
    const double plain = rms_between(flat, truth);

    EXPECT_LT(guided, 0.4 * plain);
    // What cross-validation says is no less than what it estimates.
    EXPECT_LT(guided, 1.5 * interpolation.candidates.front().cv_relative);
  }
}

TEST(InterpolateScan, TakesAFittedSurfaceThatIsBetterThanItsOwn) {
  const MeasuredScan scan = perfect_scan(wheat(), geometries(kTenDegrees));

  const Interpolation interpolation = interpolate_scan(scan, {.table = {}, .fitted = wheat()}).value();

  EXPECT_EQ(interpolation.best().guide().name, "fitted");
  EXPECT_LT(rms_between(Surface(interpolation.best()), wheat()), 1e-3);
}

TEST(InterpolateScan, ReadsAScanInThePlaneOfIncidenceAlone) {
  SimulatedGrid grid{.theta_i = {30}, .theta_r = {0, 15, 30, 45, 60, 75}, .phi_step = 180};
  const MeasuredScan scan = perfect_scan(wheat(), geometries(grid));

  const Result<Interpolation> interpolation = interpolate_scan(scan);

  ASSERT_TRUE(interpolation) << describe(interpolation.error());
  EXPECT_NEAR(Surface(interpolation->best()).eval(geometry(30, 60, 180)) / wheat().eval(geometry(30, 60, 180)), 1.0,
              1e-9);
}

TEST(InterpolatedScan, IsASurfaceThatIsIntegratedAndSampled) {
  const MeasuredScan scan = perfect_scan(wheat(), geometries(kTenDegrees));
  const Surface surface = interpolate_scan(scan).value().best();
  const Direction i = Direction::from_angles(degrees(40.0), Angle{});

  const double rho = rho_dh(surface, i, 1e-4).value;
  const auto sampler = make_sampler(surface, i).value();
  double weights = 0.0;
  const RandomStream stream(4);
  for (std::uint64_t k = 0; k < 20000; ++k) weights += sampler->sample(stream, k).weight / 20000.0;

  EXPECT_NEAR(rho / rho_dh(wheat(), i).value, 1.0, 0.01);
  EXPECT_NEAR(weights / rho, 1.0, 0.01);
}

TEST(InterpolateScan, HandsOnWhatIsWrongWithTheScan) {
  EXPECT_EQ(interpolate_scan(MeasuredScan{}).error().code, ErrorCode::InvalidInput);
  MeasuredScan one = perfect_scan(wheat(), {geometry(30, 30, 0)});

  EXPECT_EQ(interpolate_scan(one).error().limit, "at least two directions");
}

}  // namespace
}  // namespace gonio::reflectance::test
