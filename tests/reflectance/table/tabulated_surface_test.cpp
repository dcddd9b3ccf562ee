#include "reflectance/table/tabulated_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "reflectance/table/detect_feature.h"
#include "reflectance/table/table_of_readings.h"
#include "tests/reflectance/generated.h"
#include "tests/reflectance/surfaces.h"
#include "tests/reflectance/table/tables.h"

namespace gonio::reflectance {
namespace {

using Readings = std::vector<TableReading>;

// A brushed surface: wheat whose brightness follows the direction of the brush, left and right unlike.
struct Brushed {
  Surface under = wheat();
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    const double along = std::cos(2.0 * (i.phi().si() - 0.4)) * i.sin_theta();
    const double left = 0.3 * r.sin_theta() * std::sin(r.phi().si() - i.phi().si());
    return under.eval(i, r) * (1.0 + 0.4 * along + left);
  }
  [[nodiscard]] std::string_view model() const { return "brushed"; }
  [[nodiscard]] Parameters parameters() const { return {}; }
  [[nodiscard]] bool is_isotropic() const { return false; }
};

double value(const TabulatedSurface& t, const Direction& i, const Direction& r) {
  return in_per_steradian(t.eval(i, r));
}

bool same_bits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

Readings wheat_grid(std::initializer_list<double> thetas, const ViewGrid& grid = {.last = 85.0}) {
  Readings readings;
  for (const double theta : thetas) add_grid(readings, wheat(), direction_deg(theta, 0.0), grid);
  return readings;
}

TEST(TabulatedSurface, GivesEachReadingBack) {
  for (const TableLayout layout : {TableLayout::Rings, TableLayout::Scattered}) {
    for (const TableSymmetry symmetry : {TableSymmetry::Isotropic, TableSymmetry::Turn, TableSymmetry::Anisotropic}) {
      const Readings readings = wheat_grid({0.0, 20.0, 40.0, 60.0});
      const TabulatedSurface t = table(readings, {.symmetry = symmetry, .layout = layout});
      for (const TableReading& reading : readings) {
        const double f =
            in_per_steradian(t.eval(incident_direction(reading.geometry), reflected_direction(reading.geometry)));
        EXPECT_NEAR(f / in_per_steradian(reading.f.value), 1.0, 1e-7)
            << "at " << in_degrees(reading.geometry.theta_r) << ", " << in_degrees(reading.geometry.phi_r);
      }
    }
  }
}

TEST(TabulatedSurface, OfScatteredReadingsGivesEachBack) {
  Readings readings;
  for (const double theta : {0.0, 30.0, 60.0}) add_spiral(readings, wheat(), direction_deg(theta, 0.0), 500);
  const TabulatedSurface t = table(readings, {.symmetry = TableSymmetry::Turn});
  for (const TableReading& reading : readings) {
    if (reading.geometry.theta_i == Angle{}) continue;  // there readings of unlike azimuth are averaged
    const double f =
        in_per_steradian(t.eval(incident_direction(reading.geometry), reflected_direction(reading.geometry)));
    EXPECT_NEAR(f / in_per_steradian(reading.f.value), 1.0, 1e-9);
  }
}

TEST(TabulatedSurface, LiesAsCloseToTheTruthAsLinearInterpolationCan) {
  // Bilinear at 190 and 703 points: 0.24 and 0.07 % rms, 1.8 and 0.5 % at most (the physics notes, scan grids).
  const Direction i = direction_deg(30.0, 0.0);
  Readings coarse;
  Readings fine;
  add_spiral(coarse, wheat(), i, 190);
  add_spiral(fine, wheat(), i, 703);
  const InterpolationError of_coarse = interpolation_error(wheat(), table(coarse), i, 80.0);
  const InterpolationError of_fine = interpolation_error(wheat(), table(fine), i, 80.0);
  EXPECT_LT(of_coarse.rms, 0.004);
  EXPECT_LT(of_fine.rms, 0.0013);
  EXPECT_LT(of_fine.rms, 0.45 * of_coarse.rms) << "second order: 703 / 190 points halve the step";

  const Readings rings = wheat_grid({30.0}, {.theta_step = 5.0, .phi_step = 10.0, .last = 85.0, .turn_deg = 180.0});
  const InterpolationError of_rings =
      interpolation_error(wheat(), table(rings, {.layout = TableLayout::Rings}), i, 80.0);
  EXPECT_LT(of_rings.rms, 0.0012);
  EXPECT_LT(of_rings.most, 0.01);
}

TEST(TabulatedSurface, StaysWithinTheReadingsSignsIncluded) {
  Readings readings = wheat_grid({30.0});
  for (std::size_t k = 0; k < readings.size(); ++k) {
    readings[k].f.value = per_steradian(k % 3 == 0 ? -0.01 : 0.02 + 1e-5 * static_cast<double>(k));
  }
  GeneratedDirections directions(3);
  const TabulatedSurface t = table(readings);
  bool seen_below = false;
  for (int k = 0; k < 5000; ++k) {
    const double f = value(t, directions.next(), directions.next());
    EXPECT_GE(f, -0.01);
    EXPECT_LE(f, 0.04);
    seen_below = seen_below || f < 0.0;
  }
  EXPECT_TRUE(seen_below);
}

TEST(TabulatedSurface, OfAnIsotropicSampleIsUnchangedByATurnOrAMirror) {
  Readings readings;
  for (const double theta : {20.0, 40.0, 60.0}) add_spiral(readings, wheat(), direction_deg(theta, 0.0), 300);
  for (const TableSymmetry symmetry : {TableSymmetry::Isotropic, TableSymmetry::Turn}) {
    const TabulatedSurface t = table(readings, {.symmetry = symmetry});
    EXPECT_EQ(t.is_isotropic(), symmetry == TableSymmetry::Isotropic);
    GeneratedDirections directions(5);
    for (int k = 0; k < 2000; ++k) {
      const Direction i = directions.next();
      const Direction r = directions.next();
      const Angle turn = degrees(360.0 * directions.unit());
      const Direction i2 = Direction::from_cosine(i.mu(), i.sin_theta(), i.phi() + turn);
      const Direction r2 = Direction::from_cosine(r.mu(), r.sin_theta(), r.phi() + turn);
      EXPECT_NEAR(value(t, i2, r2), value(t, i, r), 1e-9) << in_degrees(i.theta()) << ' ' << in_degrees(r.theta());
      if (symmetry == TableSymmetry::Turn) continue;
      const Direction image = Direction::from_cosine(r.mu(), r.sin_theta(), 2.0 * i.phi() - r.phi());
      EXPECT_NEAR(value(t, i, image), value(t, i, r), 1e-9);
    }
  }
}

TEST(TabulatedSurface, IsSeamlessWhereTheAzimuthWraps) {
  Readings readings;
  add_grid(readings, Surface(Brushed()), direction_deg(40.0, 0.0), {.last = 85.0});
  for (const TableLayout layout : {TableLayout::Rings, TableLayout::Scattered}) {
    const TabulatedSurface t = table(readings, {.symmetry = TableSymmetry::Turn, .layout = layout});
    const Direction i = direction_deg(40.0, 0.0);
    for (const double theta : {12.0, 40.0, 71.0}) {
      EXPECT_NEAR(value(t, i, direction_deg(theta, 359.9999999)), value(t, i, direction_deg(theta, 1e-7)), 1e-8);
      EXPECT_NEAR(value(t, i, direction_deg(theta, 180.0000001)), value(t, i, direction_deg(theta, 179.9999999)), 1e-8);
      EXPECT_NEAR(value(t, i, direction_deg(theta, 355.0)),
                  in_per_steradian(Brushed().eval(i, direction_deg(theta, 355.0))), 0.01);
    }
  }
}

TEST(TabulatedSurface, KeepsLeftAndRightApartWhereOnlyATurnIsDeclared) {
  Readings readings;
  const Direction i = direction_deg(40.0, 0.0);
  add_grid(readings, Surface(Brushed()), i, {.last = 85.0});
  const TabulatedSurface t = table(readings, {.symmetry = TableSymmetry::Turn, .layout = TableLayout::Rings});
  const Direction left = direction_deg(50.0, 90.0);
  const Direction right = direction_deg(50.0, -90.0);
  EXPECT_NEAR(value(t, i, left), in_per_steradian(Brushed().eval(i, left)), 1e-12);
  EXPECT_NEAR(value(t, i, right), in_per_steradian(Brushed().eval(i, right)), 1e-12);
  EXPECT_GT(value(t, i, left), 1.3 * value(t, i, right));
}

TEST(TabulatedSurface, FollowsTheIncidentAzimuthOfAnAnisotropicSample) {
  const Surface truth = Brushed();
  const auto error_with_step = [&](double step) {
    Readings readings;
    add_spiral(readings, truth, Direction(), 700);
    for (const double theta : {20.0, 40.0, 60.0}) {
      for (double phi = 0.0; phi < 359.0; phi += step) add_spiral(readings, truth, direction_deg(theta, phi), 700);
    }
    const TabulatedSurface t = table(readings, {.symmetry = TableSymmetry::Anisotropic});
    double worst = 0.0;
    for (const double phi : {-170.0, -35.0, 7.0, 100.0, 355.0}) {
      worst = std::max(worst, interpolation_error(truth, t, direction_deg(40.0, phi), 75.0).rms);
    }
    return worst;
  };
  const double of_30 = error_with_step(30.0);
  const double of_15 = error_with_step(15.0);
  EXPECT_LT(of_30, 0.05);
  EXPECT_LT(of_15, 0.3 * of_30) << "second order in phi_i";
}

TEST(TabulatedSurface, MergesThePoleAndRepeatedReadings) {
  Readings readings = wheat_grid({30.0});
  const Geometry pole{.theta_i = degrees(30.0), .phi_i = {}, .theta_r = {}, .phi_r = {}};
  readings[0].f = {.value = per_steradian(0.20), .u = per_steradian(0.01)};
  for (const double phi : {90.0, 200.0}) {
    Geometry g = pole;
    g.phi_r = degrees(phi);
    readings.push_back({.geometry = g, .f = {.value = per_steradian(0.29), .u = per_steradian(0.01)}});
  }
  const TabulatedSurface t = table(readings, {.layout = TableLayout::Rings});

  // The mean of 0.20, 0.29, 0.29: 0.26, off the first by 6 u; Birge: chi^2 = 36 + 9 + 9, sqrt(54/2) = 5.196.
  EXPECT_NEAR(value(t, direction_deg(30.0, 0.0), Direction()), 0.26, 1e-12);
  const Measured<Brdf> m = t.measured(direction_deg(30.0, 0.0), Direction());
  EXPECT_NEAR(in_per_steradian(m.u), 0.01 / std::sqrt(3.0) * std::sqrt(27.0), 1e-12);
  bool found = false;
  for (const MergedReadings& merged : t.report().merged) {
    if (merged.geometry.theta_r > Angle{}) continue;
    found = true;
    EXPECT_EQ(merged.count, 3u);
    EXPECT_NEAR(merged.largest_deviation, 6.0, 1e-9);
    EXPECT_TRUE(merged.disagree);
  }
  EXPECT_TRUE(found);
  EXPECT_EQ(t.report().disagreeing, 1u);
}

TEST(TabulatedSurface, InterpolatesUncertaintiesWithTheWeightsOfTheValues) {
  Readings readings = wheat_grid({30.0, 50.0});
  for (TableReading& reading : readings) reading.f.u = 0.02 * reading.f.value;
  const TabulatedSurface t = table(readings, {.symmetry = TableSymmetry::Turn});  // none are merged
  GeneratedDirections directions(9);
  for (int k = 0; k < 500; ++k) {
    const Direction r = directions.next();
    if (r.theta() > degrees(85.0)) continue;
    const Measured<Brdf> m = t.measured(direction_deg(40.0, 0.0), r);
    EXPECT_NEAR(m.u.si() / m.value.si(), 0.02, 1e-12);
    EXPECT_NEAR(m.value.si(), value(t, direction_deg(40.0, 0.0), r), 1e-15);
  }
}

TEST(TabulatedSurface, TellsWhatItCovers) {
  // A detector's shadow of 6 deg about retro, an arm that reaches 75 deg, incidences of 20 to 60 deg.
  const Surface truth = wheat();
  Readings readings;
  for (const double theta : {20.0, 40.0, 60.0}) {
    Readings all;
    add_grid(all, truth, direction_deg(theta, 0.0), {.theta_step = 2.5, .phi_step = 5.0, .last = 75.0});
    for (const TableReading& r : all) {
      if (phase_angle(r.geometry) > degrees(6.0)) readings.push_back(r);
    }
  }
  const TabulatedSurface t = table(readings, {.widest_cell = degrees(7.0)});
  const Direction i = direction_deg(40.0, 0.0);
  EXPECT_TRUE(t.covers(i, direction_deg(20.0, 100.0)));
  EXPECT_TRUE(t.covers(i, direction_deg(74.0, 180.0)));
  EXPECT_FALSE(t.covers(i, direction_deg(76.0, 180.0)));
  EXPECT_FALSE(t.covers(i, direction_deg(40.0, 0.5))) << "in the shadow";
  EXPECT_TRUE(t.covers(direction_deg(50.0, 10.0), direction_deg(20.0, 100.0)));
  EXPECT_FALSE(t.covers(direction_deg(61.0, 10.0), direction_deg(20.0, 100.0)));

  // cos^2(75 deg) = 6.70 % beyond the arm; the shadow is pi sin^2(6 deg) cos(40 deg) / pi = 0.8 %, cells are coarser.
  EXPECT_NEAR(t.extrapolated_share(i), 0.067 + 0.008, 0.008);
  EXPECT_NEAR(t.extrapolated_share(direction_deg(70.0, 0.0)), 1.0, 1e-12);
}

TEST(TabulatedSurface, HoldsOrContinuesBeyondItsReach) {
  const Surface truth = surface("minnaert", {{"rho", 0.5}, {"k", 0.5}});
  for (const double theta_i : {0.0, 30.0, 60.0}) {
    const Direction i = direction_deg(theta_i, 0.0);
    Readings readings;
    add_grid(readings, truth, i, {.last = 70.0});
    const TabulatedSurface held = table(readings, {.layout = TableLayout::Rings});
    const TabulatedSurface continued = table(readings, {.layout = TableLayout::Rings, .beyond = BeyondReach::Continue});
    for (const double phi : {0.0, 60.0, 130.0, 180.0}) {
      const double edge = value(held, i, direction_deg(70.0, phi));
      EXPECT_NEAR(value(held, i, direction_deg(85.0, phi)), edge, 1e-9);
      EXPECT_NEAR(value(continued, i, direction_deg(70.0000001, phi)), edge, 1e-6) << "no step at the edge";
      const double at_80 = in_per_steradian(truth.eval(i, direction_deg(80.0, phi)));
      EXPECT_LT(std::abs(value(continued, i, direction_deg(80.0, phi)) - at_80), 0.6 * std::abs(edge - at_80));
    }
  }
}

TEST(TabulatedSurface, MovesAHotSpotInsteadOfShowingTwo) {
  // A peak of 1 deg about retro, 100 times the floor.
  struct Retro {
    [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
      const double s2 = sin2_half_phase(i, r);
      return per_steradian(0.1 + 10.0 * std::exp(-s2 / (2.0 * 7.6e-5)));
    }
    [[nodiscard]] std::string_view model() const { return "retro"; }
    [[nodiscard]] Parameters parameters() const { return {}; }
    [[nodiscard]] bool is_isotropic() const { return true; }
  };
  const Surface truth = Retro();
  Readings readings;
  for (const double theta : {15.0, 30.0, 60.0}) {
    const Direction i = direction_deg(theta, 0.0);
    add_spiral(readings, truth, i, 400);
    for (int ring = 0; ring <= 12; ++ring) {
      for (int k = 0; k < 36; ++k) {
        const double xi = degrees(0.4 * ring).si();
        const double psi = degrees(10.0 * k).si();
        const Direction r =
            Direction::from_vector({.x = std::cos(xi) * i.sin_theta() - std::sin(xi) * std::cos(psi) * i.mu(),
                                    .y = std::sin(xi) * std::sin(psi),
                                    .z = std::cos(xi) * i.mu() + std::sin(xi) * std::cos(psi) * i.sin_theta()});
        readings.push_back(reading_of(truth, i, r));
        if (ring == 0) break;
      }
    }
  }
  const TabulatedSurface t = table(readings);
  EXPECT_EQ(t.feature(), Feature::HotSpot);
  for (const double theta : {16.0, 22.5, 37.0, 45.0, 59.0}) {
    const Direction i = direction_deg(theta, 20.0);
    EXPECT_NEAR(value(t, i, i), 10.1, 1e-9);
    for (const double off : {-1.0, 0.5, 2.0}) {
      const Direction r = direction_deg(theta + off, 20.0);
      EXPECT_NEAR(value(t, i, r), in_per_steradian(truth.eval(i, r)), 0.25);
    }
    // Where the neighbours had theirs there is none now.
    for (const double ghost : {15.0, 30.0, 60.0}) {
      if (std::abs(ghost - theta) < 5.0) continue;
      EXPECT_NEAR(value(t, i, direction_deg(ghost, 20.0)), 0.1, 0.005);
    }
  }
}

TEST(TabulatedSurface, MovesALobeToTheMirrorDirectionOfTheIncidence) {
  Readings readings;
  const Surface truth = surface("glint", {{"slope_variance", 0.004}, {"refractive_index", 1.34}});
  for (const double theta : {30.0, 40.0, 50.0}) {
    add_grid(readings, truth, direction_deg(theta, 0.0), {.theta_step = 1.0, .phi_step = 2.0, .last = 85.0});
  }
  const TabulatedSurface t = table(readings, {.layout = TableLayout::Rings});
  EXPECT_EQ(t.feature(), Feature::Lobe);
  const Direction i = direction_deg(45.0, 0.0);
  const double peak = in_per_steradian(truth.eval(i, direction_deg(45.0, 180.0)));
  EXPECT_NEAR(value(t, i, direction_deg(45.0, 180.0)) / peak, 1.0, 0.12) << "8 % is the bend of f";
  const TabulatedSurface faded = table(readings, {.layout = TableLayout::Rings, .feature = Feature::Smooth});
  EXPECT_LT(interpolation_error(truth, t, i, 80.0).rms, 0.5 * interpolation_error(truth, faded, i, 80.0).rms);
}

TEST(TabulatedSurface, FindsWhatStandsOut) {
  const auto found = [](const Surface& truth) {
    Readings readings;
    for (const double theta : {20.0, 40.0}) add_spiral(readings, truth, direction_deg(theta, 0.0), 700);
    return table(readings).feature();
  };
  EXPECT_EQ(found(wheat()), Feature::HotSpot);
  EXPECT_EQ(found(sea()), Feature::Lobe);
  EXPECT_EQ(found(surface("lambertian", {{"rho", 0.5}})), Feature::Smooth);
  EXPECT_EQ(found(surface("minnaert", {{"rho", 0.5}, {"k", 0.5}})), Feature::Smooth);
}

TEST(TabulatedSurface, IsReciprocalToTheBitWhenAskedTo) {
  Readings readings;
  for (const double theta : {0.0, 25.0, 50.0, 70.0}) {
    add_spiral(readings, Surface(Brushed()), direction_deg(theta, 0.0), 300);
  }
  for (const TableSymmetry symmetry : {TableSymmetry::Isotropic, TableSymmetry::Turn}) {
    const TabulatedSurface t = table(readings, {.symmetry = symmetry, .reciprocal = true});
    GeneratedDirections directions(13);
    for (int k = 0; k < 3000; ++k) {
      const Direction i = directions.next();
      const Direction r = directions.next();
      EXPECT_TRUE(same_bits(value(t, i, r), value(t, r, i)));
    }
    // Near a reading it says what was read, whatever is interpolated for the partner.
    const TabulatedSurface one_way = table(readings, {.symmetry = symmetry});
    const Direction i = direction_deg(25.0, 0.0);
    const Direction r = reflected_direction(readings[450].geometry);
    EXPECT_NEAR(value(t, i, r) / value(one_way, i, r), 1.0, 0.02);
  }
}

struct Refusal {
  std::string why;
  Readings readings;
  TableOptions options;
  std::string seen;
};

std::vector<Refusal> refusals() {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [](auto change) {
    Readings readings = wheat_grid({30.0});
    change(readings[7]);
    return readings;
  };
  return {
      {"nothing read", {}, {}, "0 readings of 0 directions"},
      {"one direction",
       Readings(3, wheat_grid({30.0})[5]),
       {.layout = TableLayout::Rings},
       "3 readings of 1 directions"},
      {"value NaN", with([&](TableReading& r) { r.f.value = per_steradian(kNan); }), {}, "reading 7: value nan /sr"},
      {"u below 0", with([](TableReading& r) { r.f.u = per_steradian(-0.5); }), {}, "reading 7: uncertainty -0.5 /sr"},
      {"u NaN", with([&](TableReading& r) { r.f.u = per_steradian(kNan); }), {}, "reading 7: uncertainty nan /sr"},
      {"theta_i", with([](TableReading& r) { r.geometry.theta_i = degrees(-30.0); }), {}, "reading 7: theta_i -30 deg"},
      {"theta_r", with([](TableReading& r) { r.geometry.theta_r = degrees(91.0); }), {}, "reading 7: theta_r 91 deg"},
      {"phi_r", with([&](TableReading& r) { r.geometry.phi_r = radians(kNan); }), {}, "reading 7: phi_r nan deg"},
      {"phi_i", with([&](TableReading& r) { r.geometry.phi_i = radians(kNan); }), {}, "reading 7: phi_i nan deg"},
      {"tolerance", wheat_grid({30.0}), {.same_direction = degrees(0.0)}, "option same_direction 0 deg"},
      {"cell", wheat_grid({30.0}), {.widest_cell = radians(kNan)}, "option widest_cell nan deg"},
  };
}

TEST(TabulatedSurface, RefusesWhatIsNoMeasurement) {
  for (const Refusal& refusal : refusals()) {
    SCOPED_TRACE(refusal.why);
    const auto made = TabulatedSurface::make(refusal.readings, refusal.options);
    ASSERT_FALSE(made.has_value());
    EXPECT_EQ(made.error().code, ErrorCode::InvalidInput);
    EXPECT_EQ(made.error().seen, refusal.seen);
  }
}

TEST(TabulatedSurface, WantsRingsForReadingsInOnePlane) {
  Readings readings;
  for (double theta = -80.0; theta <= 80.0; theta += 5.0) {
    readings.push_back(
        reading_of(wheat(), direction_deg(30.0, 0.0), direction_deg(std::abs(theta), theta < 0 ? 180.0 : 0.0)));
  }
  const auto scattered = TabulatedSurface::make(readings, {});
  ASSERT_FALSE(scattered.has_value());
  EXPECT_NE(scattered.error().limit.find("rings"), std::string::npos);

  const TabulatedSurface t = table(readings, {.layout = TableLayout::Rings});
  const Direction i = direction_deg(30.0, 0.0);
  EXPECT_TRUE(t.covers(i, direction_deg(41.0, 180.0)) || t.extrapolated_share(i) > 0.5);
  EXPECT_FALSE(t.covers(i, direction_deg(41.0, 90.0)));

  const auto found = table_of_readings(readings, {});
  ASSERT_TRUE(found.has_value()) << describe(found.error());
  EXPECT_EQ(found->options().layout, TableLayout::Rings);
  EXPECT_EQ(table_of_readings(wheat_grid({30.0}), {})->options().layout, TableLayout::Scattered);
}

// Turns of the sample 60 deg apart: between them nothing was measured, at each of them all was, though an encoder ends
// a thousandth of a degree beside it and a hair of the next theta_i's row comes in.
TEST(TabulatedSurface, CoversATurnOfTheSampleWhereAnEncoderEndsBesideIt) {
  Readings readings;
  for (const double theta_i : {20.0, 80.0}) {
    for (double phi_i = 0.0; phi_i < 360.0; phi_i += 60.0)
      add_grid(readings, Brushed(), direction_deg(theta_i, phi_i), {.last = 80.0});
  }
  const TabulatedSurface t =
      table(readings, {.symmetry = TableSymmetry::Anisotropic, .widest_incidence_step = degrees(70.0)});
  const TabulatedSurface strict =
      table(readings, {.symmetry = TableSymmetry::Anisotropic, .widest_incidence_step = degrees(10.0)});

  const Direction r = direction_deg(40.0, 200.0);
  for (const double theta_i : {20.0, 20.003, 79.999}) {
    EXPECT_TRUE(t.covers(direction_deg(theta_i, 60.003), r)) << theta_i;
    EXPECT_TRUE(strict.covers(direction_deg(theta_i, 60.003), r)) << theta_i;
    EXPECT_FALSE(strict.covers(direction_deg(theta_i, 75.0), r)) << theta_i;
  }
}

// A table in half and difference angles has an incidence for each of its million values.
TEST(TabulatedSurface, RefusesAnIncidenceForEachReadingWithoutLookingAtAllOfThem) {
  Readings readings;
  for (int k = 0; k < 100'000; ++k) {
    const Direction i = direction_deg(80.0 * static_cast<double>(k) / 100'000.0, 0.0);
    readings.push_back(reading_of(wheat(), i, direction_deg(20.0, 90.0)));
  }

  const auto made = TabulatedSurface::make(readings, {.same_direction = degrees(1e-4)});

  ASSERT_FALSE(made.has_value());
  EXPECT_NE(made.error().seen.find("4097 incidences in the first 4097 of 100000"), std::string::npos);
}

}  // namespace
}  // namespace gonio::reflectance
