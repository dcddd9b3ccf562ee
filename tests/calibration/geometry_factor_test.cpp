#include "calibration/geometry_factor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/absolute_factor.h"
#include "calibration/overlap.h"
#include "tests/calibration/scan_builder.h"
#include "tests/sim/effects/effects_bench.h"

namespace gonio::calibration {
namespace {

constexpr double kPi = std::numbers::pi;
const Geometry kAnchor = directions(0, 45, 0);

InstrumentModel instrument(double spot_mm, double field_mm, double u_relative = 0.01) {
  InstrumentModel model;
  auto& overlap = model.overlap.emplace();
  overlap.spot_radius = {millimetres(spot_mm), millimetres(spot_mm * u_relative)};
  overlap.field_radius = {millimetres(field_mm), millimetres(field_mm * u_relative)};
  return model;
}

double cosine(double deg) {
  return std::cos(deg * kPi / 180.0);
}

double term(const std::vector<RelativeTerm>& terms, std::string_view name) {
  const auto found = std::find_if(terms.begin(), terms.end(), [&](const RelativeTerm& t) { return t.name == name; });
  return found == terms.end() ? 0.0 : found->per_sd;
}

TEST(GeometryRatio, WithoutSpotAndFieldIsTheCosineOfTheRadianceMode) {
  const GeometryRatio found = geometry_ratio(directions(60, 30, 90), kAnchor, InstrumentModel{});

  EXPECT_NEAR(found.factor, 1.0 / cosine(60), 1e-14);
  EXPECT_NEAR(found.sample_slope[0], -std::tan(kPi / 3.0), 1e-14);
  EXPECT_EQ(found.sample_slope[1], 0.0);
  EXPECT_TRUE(found.terms.empty());
  EXPECT_FALSE(found.is_mixed);
}

TEST(GeometryRatio, IsEitherCosineInEitherLimit) {
  const Geometry g = directions(40, 70, 120);

  const GeometryRatio radiance = geometry_ratio(g, kAnchor, instrument(80, 5));
  const GeometryRatio intensity = geometry_ratio(g, kAnchor, instrument(5, 80));

  EXPECT_NEAR(radiance.factor, 1.0 / cosine(40), 1e-13);
  EXPECT_NEAR(intensity.factor, cosine(45) / cosine(70), 1e-13);
  EXPECT_NEAR(intensity.sample_slope[1], -std::tan(70.0 * kPi / 180.0), 1e-13);
  EXPECT_NEAR(intensity.reference_slope[1], -1.0, 1e-13);
  EXPECT_TRUE(radiance.terms.empty()) << "no radius counts where both readings are in one limit";
  EXPECT_TRUE(intensity.terms.empty());
}

TEST(GeometryRatio, ChosenWrongByOneLimitIsTheRatioOfTheCosines) {
  const Geometry g = directions(0, 75, 0);
  const double radiance = geometry_ratio(g, directions(0, 0, 0), instrument(80, 5)).factor;
  const double intensity = geometry_ratio(g, directions(0, 0, 0), instrument(5, 80)).factor;

  EXPECT_NEAR(intensity / radiance, 3.9, 0.05);
}

TEST(GeometryRatio, IsWhatTheSimulatedInstrumentsReadingsHave) {
  // Its overlap is computed by another algorithm, in another room.
  for (const auto& [spot, field] : {std::pair{6.0, 5.0}, {10.0, 3.0}, {3.0, 10.0}, {5.0, 5.0}}) {
    sim::Scene scene = sim::test::quiet_scene();
    scene.effects.overlap = sim::OverlapSpec{.spot_radius = millimetres(spot),
                                             .field_radius = millimetres(field),
                                             .sample_radius = millimetres(12.0),
                                             .reference_radius = std::nullopt};
    InstrumentModel model = instrument(spot, field);
    model.overlap->sample_radius = millimetres(12.0);
    const double at_anchor = sim::test::target_rate(scene, kAnchor, sim::test::kReferenceMm);
    sim::Scene endless = scene;
    endless.effects.overlap->sample_radius.reset();
    const double standard = at_anchor / sim::test::target_rate(endless, kAnchor);  // its BRDF over the sample's
    for (const Geometry& g : {directions(0, 0, 0), directions(60, 60, 90), directions(30, 80, 170),
                              directions(75, 10, 40), directions(70, 70, 0)}) {
      const double reading = sim::test::target_rate(scene, g) / at_anchor * standard;

      const GeometryRatio found = geometry_ratio(g, kAnchor, model);

      // It may miss two crossings closer than 1/512 turn: below 1e-6 of the area.
      EXPECT_NEAR(found.factor * reading, 1.0, 1e-7) << spot << " " << field << " " << in_degrees(g.theta_r);
    }
  }
}

TEST(GeometryRatio, SaysWhereItIsMixed) {
  EXPECT_TRUE(geometry_ratio(directions(60, 60, 90), kAnchor, instrument(8, 5)).is_mixed);
  EXPECT_FALSE(geometry_ratio(directions(60, 60, 180), kAnchor, instrument(8.5, 5)).is_mixed);
  EXPECT_TRUE(geometry_ratio(directions(0, 60, 0), kAnchor, instrument(10.5, 5, 0.05)).is_mixed)
      << "the field is 10 mm long there, and nobody knows which of the two is larger";
}

TEST(GeometryRatio, ItsSlopesAreThoseOfItsLogarithm) {
  const InstrumentModel model = instrument(6, 5);
  const Geometry g = directions(50, 65, 70);
  constexpr double kStep = 1e-6;
  const auto logarithm = [&](double i, double r, double phi) {
    return -std::log(geometry_ratio({.theta_i = g.theta_i + radians(i),
                                     .phi_i = {},
                                     .theta_r = g.theta_r + radians(r),
                                     .phi_r = g.phi_r + radians(phi)},
                                    kAnchor, model)
                         .factor);
  };

  const GeometryRatio found = geometry_ratio(g, kAnchor, model);

  EXPECT_NEAR(found.sample_slope[0], (logarithm(kStep, 0, 0) - logarithm(-kStep, 0, 0)) / (2 * kStep), 1e-6);
  EXPECT_NEAR(found.sample_slope[1], (logarithm(0, kStep, 0) - logarithm(0, -kStep, 0)) / (2 * kStep), 1e-6);
  EXPECT_NEAR(found.sample_slope[2], (logarithm(0, 0, kStep) - logarithm(0, 0, -kStep)) / (2 * kStep), 1e-6);
}

TEST(GeometryRatio, ATermIsWhatItsErrorDoesToTheFactor) {
  InstrumentModel model = instrument(6, 5);
  model.overlap->sample_radius = millimetres(9.0);
  model.overlap->u_target_radius = millimetres(0.1);
  const Geometry g = directions(60, 70, 60);
  const GeometryRatio found = geometry_ratio(g, kAnchor, model);
  const auto changed = [&](auto change) {
    InstrumentModel other = model;
    change(*other.overlap);
    return std::log(geometry_ratio(g, kAnchor, other).factor / found.factor);
  };

  EXPECT_NEAR(term(found.terms, "radius of the lit spot"),
              changed([](OverlapModel& m) { m.spot_radius.value = 1.01 * m.spot_radius.value; }), 2e-4);
  EXPECT_NEAR(term(found.terms, "radius of the field of view"),
              changed([](OverlapModel& m) { m.field_radius.value = 1.01 * m.field_radius.value; }), 2e-4);
  EXPECT_NEAR(term(found.terms, "radius of the sample"),
              changed([](OverlapModel& m) { m.sample_radius = millimetres(9.1); }), 2e-4);
}

TEST(GeometryRatio, TheTermOfAnUnevenSpotIsWhatAProfileDoes) {
  InstrumentModel model = instrument(6, 5, 0.0);
  constexpr double kFalloff = 0.02;
  model.overlap->u_spot_falloff = kFalloff;
  const Geometry g = directions(60, 70, 60);
  const GeometryRatio found = geometry_ratio(g, kAnchor, model);
  for (int k = 0; k <= 200; ++k) {
    const double at = k / 200.0;
    model.overlap->spot_profile.push_back({at, 1.0 + kFalloff * (1.0 - 2.0 * at * at)});
  }

  const GeometryRatio uneven = geometry_ratio(g, kAnchor, model);

  EXPECT_GT(std::abs(term(found.terms, "unevenness of the lit spot")), 1e-3);
  EXPECT_NEAR(term(found.terms, "unevenness of the lit spot"), std::log(uneven.factor / found.factor), 5e-5);
}

TEST(GeometryRatio, AtTheSameGeometryOnTargetsOfTheSameSizeNothingIsLeft) {
  const GeometryRatio found = geometry_ratio(directions(60, 60, 90), directions(60, 60, 90), instrument(6, 5));

  EXPECT_DOUBLE_EQ(found.factor, 1.0);
  EXPECT_TRUE(found.terms.empty());
  EXPECT_EQ(found.sample_slope, found.reference_slope);
}

TEST(GeometryRatio, AtTheSameGeometryOnASmallerSampleTheEdgeCounts) {
  InstrumentModel model = instrument(30, 5);
  model.overlap->sample_radius = millimetres(8.0);

  const GeometryRatio found = geometry_ratio(directions(0, 75, 0), directions(0, 75, 0), model);

  const double area =
      overlap_of({millimetres(30.0), millimetres(5.0), millimetres(8.0)}, directions(0, 75, 0)).area_mm2;
  EXPECT_NEAR(found.factor, kPi * 25.0 / cosine(75) / area, 1e-12);
  EXPECT_GT(found.factor, 1.5);
}

TEST(GeometryRatio, LeftOutIsTheCosineWithTheBudgetUnchanged) {
  const Geometry g = directions(60, 70, 60);

  const GeometryRatio with = geometry_ratio(g, kAnchor, instrument(6, 5));
  const GeometryRatio without = geometry_ratio(g, kAnchor, instrument(6, 5), {.overlap = true});

  EXPECT_NEAR(without.factor, 1.0 / cosine(60), 1e-14);
  EXPECT_EQ(without.terms.size(), with.terms.size());
}

InstrumentModel with_beam(double spot_mm, double field_mm) {
  InstrumentModel model = instrument(spot_mm, field_mm);
  auto& absolute = model.absolute.emplace();
  absolute.beams = {{.wavelength = nanometres(568.0), .q = {2.0, 0.002}, .attenuation = {1e-4, 2e-7}}};
  absolute.aperture_radius = {millimetres(10.0), millimetres(0.02)};
  absolute.aperture_distance = {millimetres(500.0), millimetres(0.5)};
  return model;
}

TEST(AbsoluteRatio, InIntensityGeometryIsNicodemusEquation) {
  const Geometry g = directions(30, 60, 40);

  const auto found = absolute_ratio(g, nanometres(568.0), with_beam(0.5, 40));

  ASSERT_TRUE(found) << describe(found.error());
  // f = q / (q_i Omega mu_r), Omega = A / d^2 but for some 1e-3 of the sizes.
  const double omega = kPi * 100.0 / 250000.0;
  EXPECT_NEAR(found->dvalue_dq * 2.0 / 1e-4 * omega * cosine(60), 1.0, 1e-3);
  EXPECT_FALSE(found->is_mixed);
  EXPECT_NEAR(term(found->terms, "direct beam at 568 nm"), -0.001, 1e-12);
  EXPECT_NEAR(term(found->terms, "attenuator of the direct beam at 568 nm"), 0.002, 1e-12);
  EXPECT_NEAR(term(found->terms, "radius of the detector's stop"), -0.004, 1e-12);
  EXPECT_NEAR(term(found->terms, "distance of the detector's stop"), 0.002, 1e-12);
  EXPECT_NEAR(term(found->terms, "radius of the lit spot"), 0.0, 1e-9);
}

TEST(AbsoluteRatio, BeyondTheFieldRestsOnBothRadii) {
  const auto found = absolute_ratio(directions(0, 0, 0), nanometres(568.0), with_beam(10, 5));

  ASSERT_TRUE(found);
  // The field takes a quarter of the light that the beam carries.
  const auto inside = absolute_ratio(directions(0, 0, 0), nanometres(568.0), with_beam(10, 50));
  EXPECT_NEAR(found->dvalue_dq / inside->dvalue_dq, 4.0, 1e-9);
  EXPECT_NEAR(term(found->terms, "radius of the lit spot"), 0.02, 1e-6);
  EXPECT_NEAR(term(found->terms, "radius of the field of view"), -0.02, 1e-6);
}

TEST(AbsoluteRatio, IsRefusedWithoutWhatItRestsOn) {
  const Geometry g = directions(30, 60, 40);
  InstrumentModel no_field = with_beam(0.5, 40);
  no_field.overlap.reset();

  EXPECT_EQ(absolute_ratio(g, nanometres(568.0), InstrumentModel{}).error().code, ErrorCode::IncompleteData);
  EXPECT_EQ(absolute_ratio(g, nanometres(568.0), no_field).error().code, ErrorCode::IncompleteData);
  EXPECT_EQ(absolute_ratio(g, nanometres(633.0), with_beam(0.5, 40)).error().code, ErrorCode::IncompleteData);
  EXPECT_EQ(absolute_ratio(directions(80, 100, 180), nanometres(568.0), with_beam(0.5, 40)).error().code,
            ErrorCode::IncompleteData)
      << "straight through there is no surface between";
}

AbsoluteModel stop(double radius_mm, double distance_mm) {
  AbsoluteModel model;
  model.aperture_radius = {millimetres(radius_mm), {}};
  model.aperture_distance = {millimetres(distance_mm), {}};
  return model;
}

TEST(DetectorSolidAngle, OfCoaxialDiscsIsWalshsClosedForm) {
  constexpr double kSpot = 10.0;
  constexpr double kStop = 15.0;
  constexpr double kDistance = 500.0;
  const double sum = kSpot * kSpot + kStop * kStop + kDistance * kDistance;
  const double exchange =
      0.5 * kPi * kPi * (sum - std::sqrt(sum * sum - 4.0 * kSpot * kSpot * kStop * kStop));  // mm^2 sr

  const double found = detector_solid_angle(stop(kStop, kDistance), millimetres(kSpot), {}).value.si();

  // The next order is (size / distance)^4.
  EXPECT_NEAR(found / (exchange / (kPi * kSpot * kSpot)), 1.0, 5e-6);
  EXPECT_GT(std::abs(found / (kPi * kStop * kStop / (kDistance * kDistance)) - 1.0), 1e-3);
}

TEST(DetectorSolidAngle, IsTheMeanOverSpotAndStopAtObliqueDirections) {
  const Geometry g = directions(60, 50, 70);
  constexpr double kSpot = 8.0;
  constexpr double kStop = 12.0;
  constexpr double kDistance = 500.0;
  const double mu_r = std::cos(g.theta_r.si());
  const double phi = g.phi_r.si();
  const double toward[3] = {std::sin(g.theta_r.si()) * std::cos(phi), std::sin(g.theta_r.si()) * std::sin(phi), mu_r};
  const double across[3] = {-std::sin(phi), std::cos(phi), 0.0};
  const double up[3] = {-mu_r * std::cos(phi), -mu_r * std::sin(phi), std::sin(g.theta_r.si())};
  // Gauss-like rule of six points and the middle would do; a polar grid of midpoints needs no tables.
  constexpr int kRings = 12;
  constexpr int kAround = 24;
  double sum = 0.0;
  for (int j = 0; j < kRings * kAround; ++j) {
    const double rho = kSpot * std::sqrt((j / kAround + 0.5) / kRings);
    const double turn = 2.0 * kPi * (j % kAround + 0.5) / kAround;
    const double p[3] = {rho * std::cos(turn) / std::cos(g.theta_i.si()), rho * std::sin(turn), 0.0};
    for (int k = 0; k < kRings * kAround; ++k) {
      const double r = kStop * std::sqrt((k / kAround + 0.5) / kRings);
      const double around = 2.0 * kPi * (k % kAround + 0.5) / kAround;
      double way[3];
      double length2 = 0.0;
      double along = 0.0;
      for (int n = 0; n < 3; ++n) {
        way[n] = kDistance * toward[n] + r * (std::cos(around) * across[n] + std::sin(around) * up[n]) - p[n];
        length2 += way[n] * way[n];
        along += way[n] * toward[n];
      }
      sum += way[2] * along / (length2 * length2);
    }
  }
  const double mean = sum / (kRings * kAround * kRings * kAround);

  const double found = detector_solid_angle(stop(kStop, kDistance), millimetres(kSpot), g).value.si();

  EXPECT_NEAR(found / (mean * kPi * kStop * kStop / mu_r), 1.0, 5e-6);
}

}  // namespace
}  // namespace gonio::calibration
