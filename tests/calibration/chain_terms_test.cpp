// The terms of linearity, background, cones, polarisation, mounting and wavelength: each sensitivity against the value
// itself with the input moved (JCGM 100:2008, 5.1.3), each correction against what it takes out.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "calibration/calibrate.h"
#include "calibration/mounting_term.h"
#include "calibration/polarisation_term.h"
#include "reflectance/surface/make_surface.h"
#include "sim/optics/cone_average.h"
#include "sim/optics/mounting.h"
#include "sim/optics/polarised_light.h"
#include "tests/calibration/reference_text.h"
#include "tests/calibration/scan_builder.h"

namespace gonio::calibration {
namespace {

constexpr double kPi = std::numbers::pi;
const UtcTime kToday{std::chrono::sys_days{std::chrono::year{2026} / 3 / 1}};
constexpr std::size_t kMiddle = 13;  // of a 3 x 3 x 3 grid
constexpr double kRateDn = 4e5;      // DN a second of white at normal incidence over pi

ReferenceStandard white() {
  auto parsed = ReferenceStandard::parse(ReferenceText{}.text(), "white.toml");
  EXPECT_TRUE(parsed) << describe(parsed.error());
  return std::move(parsed).value();
}

InstrumentModel quiet() {
  return {.detector = {.electrons_per_dn = 1e6}};
}

double surface(const Geometry& g) {
  return 0.1 * std::exp(0.6 * g.theta_i.si() + 0.8 * g.theta_r.si() + 0.3 * (g.phi_r - g.phi_i).si());
}

/// What the detector says of light: net DN of a target with BRDF f at g, in an exposure.
using Answer = std::function<double(double f, const Geometry& g, double exposure_s, Target target)>;

double plain(double f, const Geometry& g, double exposure_s, Target /*target*/) {
  return kRateDn * f * std::cos(g.theta_i.si()) * exposure_s;
}

ScanBuilder grid_of(const std::function<double(const Geometry&, Target)>& brdf, const Answer& answer = plain,
                    double step_deg = 5.0) {
  ScanBuilder builder({0.02, 0.01});
  builder.add_dark(0.0);
  double at_s = 0.0;
  for (int i = -1; i <= 1; ++i) {
    for (int r = -1; r <= 1; ++r) {
      for (int phi = -1; phi <= 1; ++phi) {
        const Geometry g = directions(25.0 + step_deg * i, 40.0 + step_deg * r, 70.0 + step_deg * phi);
        const auto point = builder.add_point(g);
        builder.add_item(Target::Sample, point, at_s += 1.0, 0.02,
                         answer(brdf(g, Target::Sample), g, 0.02, Target::Sample));
        builder.add_item(Target::Reference, point, at_s += 1.0, 0.01,
                         answer(brdf(g, Target::Reference), g, 0.01, Target::Reference));
      }
    }
  }
  builder.add_dark(100.0);
  return builder;
}

double flat_white(const Geometry& g, Target target) {
  return target == Target::Sample ? surface(g) : 0.99 / kPi;
}

CalibratedScan calibrated(const ScanReadings& scan, const InstrumentModel& instrument,
                          const CalibrationOptions& options = {}) {
  auto result = calibrate(scan, instrument, white(), kToday, options);
  EXPECT_TRUE(result) << describe(result.error());
  return std::move(result).value();
}

double term(const CalibratedScan& scan, std::string_view name, std::size_t point = kMiddle) {
  for (const auto* terms : {&scan.points[point].budget.shared, &scan.points[point].budget.random}) {
    for (const BudgetTerm& t : *terms) {
      if (scan.components[t.component].name == name) return t.per_sd.si();
    }
  }
  return 0.0;
}

double value(const CalibratedScan& scan, std::size_t point = kMiddle) {
  return scan.points[point].value.si();
}

const Geometry kCentre = directions(25.0, 40.0, 70.0);

TEST(ChainTerms, LinearityIsTakenOutOfEachReading) {
  InstrumentModel bent = quiet();
  bent.detector.linearity.coefficients = {0.02, -0.01, 0.004};
  const Answer answer = [](double f, const Geometry& g, double exposure_s, Target target) {
    const double light = plain(f, g, exposure_s, target);
    double net = light;  // the N whose light is N (1 + a1 x + a2 x^2 + a3 x^3)
    for (int step = 0; step < 60; ++step) {
      const double x = net / 4095.0;
      net = light / (1.0 + 0.02 * x - 0.01 * x * x + 0.004 * x * x * x);
    }
    return net;
  };
  const ScanBuilder scan = grid_of(flat_white, answer);

  EXPECT_NEAR(value(calibrated(ScanBuilder(scan).scan(), bent)), surface(kCentre), 1e-12);
  EXPECT_GT(
      std::abs(value(calibrated(ScanBuilder(scan).scan(), bent, {.left_out = {.linearity = true}})) / surface(kCentre) -
               1.0),
      1e-3);
}

TEST(ChainTerms, LinearityFitIsTheDifferenceQuotientOfEachIndependentPart) {
  InstrumentModel model = quiet();
  model.detector.linearity = {.coefficients = {0.01}, .covariance = {4e-6, 3e-8, 3e-8, 1e-9}};  // a1, t0
  ScanReadings scan = grid_of(flat_white).scan();
  const CalibratedScan there = calibrated(scan, model);
  const double first = 2e-3;  // Cholesky by hand: column 1 is (2e-3, 3e-8 / 2e-3), column 2 (0, the rest)
  const double tied = 1.5e-5;
  const double rest = std::sqrt(1e-9 - tied * tied);
  const auto moved = [&](double a1, double t0) {
    InstrumentModel other = model;
    other.detector.linearity.coefficients[0] += a1;
    other.detector.exposure_offset_s.value += t0;
    return value(calibrated(scan, other)) - value(there);
  };

  const double both = moved(first, tied);
  const double alone = moved(0.0, rest);

  EXPECT_NEAR(term(there, "linearity and exposure offset, part 1"), both, 0.01 * std::abs(both));
  EXPECT_NEAR(term(there, "linearity and exposure offset, part 2"), alone, 0.01 * std::abs(alone));
}

TEST(ChainTerms, AmbientAndTrapVisitsAreSubtractedAndCancelTheirOwnDarks) {
  constexpr double kAmbientDn = 300.0;  // a second
  constexpr double kStrayDn = 2000.0;
  const Answer answer = [](double f, const Geometry& g, double exposure_s, Target target) {
    return plain(f, g, exposure_s, target) + (kAmbientDn + kStrayDn) * exposure_s;
  };
  ScanReadings scan = grid_of(flat_white, answer).scan();
  for (const Target target : {Target::Ambient, Target::Trap}) {
    RawReading visit = scan.readings[1];
    visit.id = visit.visit_id = target == Target::Ambient ? 9001 : 9002;
    visit.target = target;
    visit.point_index.reset();
    const double level = kAmbientDn + (target == Target::Trap ? kStrayDn : 0.0);
    visit.frames[0].region.mean = ScanBuilder::kDarkDn + level * visit.frames[0].exposure_s;
    scan.readings.push_back(visit);
  }

  EXPECT_NEAR(value(calibrated(scan, quiet())), surface(kCentre), 1e-10);
  const double left = value(calibrated(scan, quiet(), {.left_out = {.stray = true}}));
  EXPECT_GT(std::abs(left / surface(kCentre) - 1.0), 3e-4);
}

TEST(ChainTerms, StatedStrayShareIsTakenOutAndItsSensitivityIsTheDifferenceQuotient) {
  constexpr double kShare = 0.01;
  const Answer answer = [](double f, const Geometry& g, double exposure_s, Target target) {
    return plain(f, g, exposure_s, target) + kRateDn / kPi * kShare * exposure_s;
  };
  ScanReadings scan = grid_of(flat_white, answer).scan();
  InstrumentModel model = quiet();
  model.stray = StrayModel{.source_share = {kShare, 1e-3}, .internal_share = {}};
  InstrumentModel other = model;
  other.stray->source_share.value += 1e-3;

  const CalibratedScan there = calibrated(scan, model);
  const double change = value(calibrated(scan, other)) - value(there);

  EXPECT_NEAR(value(there), surface(kCentre), 1e-12);
  EXPECT_NEAR(term(there, "stray light of the source"), change, 0.01 * std::abs(change));
}

// The simulator's own average over both caps, by another quadrature.
TEST(ChainTerms, ConesAreTakenOutByTheBendOfTheNeighbours) {
  const sim::ConeSpec cones{.source_half = degrees(3.0), .detector_half = degrees(2.0), .tolerance = 1e-8};
  const auto averaged = [&](const Geometry& g, Target target) {
    if (target == Target::Reference) return 0.99 / kPi;
    return sim::average_over_cones(cones, g,
                                   [](const reflectance::Direction& i, const reflectance::Direction& r) {
                                     return per_steradian(surface(reflectance::geometry_of(i, r)));
                                   })
        .brdf.si();
  };
  InstrumentModel model = quiet();
  model.cones = ConeModel{.source_half = {degrees(3.0), degrees(0.1)}, .detector_half = {degrees(2.0), Angle{}}};
  ScanReadings scan = grid_of(averaged, plain, 2.0).scan();
  const double bias = averaged(kCentre, Target::Sample) - surface(kCentre);

  const CalibratedScan there = calibrated(scan, model);
  InstrumentModel other = model;
  other.cones->source_half.value += degrees(0.1);
  const double change = value(calibrated(scan, other)) - value(there);

  EXPECT_NEAR(value(there), surface(kCentre), 0.05 * std::abs(bias));
  EXPECT_NEAR(value(calibrated(scan, model, {.left_out = {.cones = true}})), surface(kCentre) + bias, 1e-9);
  EXPECT_NEAR(term(there, "half angle of the source's cone"), change, 0.03 * std::abs(change));
}

TEST(ChainTerms, ALobeAboutAsNarrowAsTheConesIsFlagged) {
  const auto lobe = [](const Geometry& g, Target target) {
    const double x = (g.theta_r - degrees(40.0)) / degrees(4.0);
    return target == Target::Reference ? 0.99 / kPi : std::exp(-0.5 * x * x);
  };
  InstrumentModel model = quiet();
  model.cones = ConeModel{.source_half = {degrees(4.0), Angle{}}, .detector_half = {degrees(4.0), Angle{}}};
  ScanReadings scan = grid_of(lobe, plain, 2.0).scan();

  EXPECT_TRUE(has(calibrated(scan, model).points[kMiddle].flags, PointFlag::InstrumentLimited));
  EXPECT_FALSE(has(calibrated(grid_of(flat_white).scan(), model).points[kMiddle].flags, PointFlag::InstrumentLimited));
}

// The simulator's view of a leaning surface, written apart, is the truth.
TEST(ChainTerms, SurfaceOnItsMountSeesWhatTheSimulatorSays) {
  const MountModel mount{
      .lean_0 = {degrees(0.4), Angle{}}, .lean_90 = {degrees(-0.3), Angle{}}, .height = {millimetres(0.7), Length{}}};
  const sim::MountSpec spec{.lean_0 = degrees(0.4), .lean_90 = degrees(-0.3), .height = millimetres(0.7)};

  const SurfaceView ours = view_on(mount, millimetres(600.0), kCentre);
  const sim::MountedView theirs = sim::view_on(spec, millimetres(600.0), millimetres(500.0), kCentre);

  EXPECT_NEAR(ours.geometry.theta_i.si(), theirs.geometry.theta_i.si(), 1e-12);
  EXPECT_NEAR(wrapped(ours.geometry.phi_i - theirs.geometry.phi_i).si(), 0.0, 1e-12);
  EXPECT_NEAR(ours.geometry.theta_r.si(), theirs.geometry.theta_r.si(), 1e-12);
  EXPECT_NEAR(wrapped(ours.geometry.phi_r - theirs.geometry.phi_r).si(), 0.0, 1e-12);
  EXPECT_NEAR(ours.irradiance, theirs.source_near * theirs.source_near, 1e-12);
}

TEST(ChainTerms, LeanAndHeightOfTheSampleAreTheDifferenceQuotient) {
  const auto seen = [](const sim::MountSpec& spec) {
    const auto brdf = [spec](const Geometry& g, Target target) {
      if (target == Target::Reference) return 0.99 / kPi;
      const sim::MountedView view = sim::view_on(spec, millimetres(600.0), millimetres(500.0), g);
      return surface(view.geometry) * std::cos(view.geometry.theta_i.si()) / std::cos(g.theta_i.si()) *
             view.source_near * view.source_near;
    };
    return grid_of(brdf);
  };
  InstrumentModel model = quiet();
  model.mounting = MountingModel{};
  model.mounting->sample = {.lean_0 = {Angle{}, degrees(0.05)},
                            .lean_90 = {Angle{}, degrees(0.05)},
                            .height = {Length{}, millimetres(0.1)},
                            .mounting = "today"};
  const CalibratedScan there = calibrated(seen({}).scan(), model);
  const std::pair<sim::MountSpec, const char*> cases[] = {{{.lean_0 = degrees(0.05)}, "lean to phi 0 of the sample"},
                                                          {{.lean_90 = degrees(0.05)}, "lean to phi 90 of the sample"},
                                                          {{.height = millimetres(0.1)}, "height of the sample"}};

  for (const auto& [spec, name] : cases) {
    const double change = value(calibrated(seen(spec).scan(), model)) - value(there);
    EXPECT_NEAR(term(there, name), change, 0.01 * std::abs(change)) << name;
  }
}

TEST(ChainTerms, PolarisationIsFreeInTheMeanOfSAndP) {
  ScanBuilder builder({0.02, 0.01});
  builder.add_dark(0.0);
  for (const Polarisation state : {Polarisation::S, Polarisation::P}) {
    const auto point = builder.add_point(kCentre);
    builder.scan().points.back().polarisation = state;
    builder.add_item(Target::Sample, point, 1.0, 0.02, plain(0.2, kCentre, 0.02, Target::Sample));
    builder.add_item(Target::Reference, point, 2.0, 0.01, plain(0.99 / kPi, kCentre, 0.01, Target::Reference));
  }
  builder.add_dark(10.0);
  InstrumentModel model = quiet();
  model.polarisation = PolarisationModel{.source_degree = 0.02, .u_sample = 0.3, .u_reference = 0.1};

  const CalibratedScan scan = calibrated(builder.scan(), model);

  ASSERT_EQ(scan.points.size(), 2U);
  const double s = term(scan, "polarisation of the sample, by the source", 0);
  const double p = term(scan, "polarisation of the sample, by the source", 1);
  EXPECT_NEAR(s, 0.2 * 0.3, 1e-12) << "light of one state: P = 1";
  EXPECT_NEAR(s + p, 0.0, 1e-15);
}

TEST(ChainTerms, FacetDiattenuationIsFresnels) {
  // Brewster's angle of 1.34 is 53.2671733355106 deg: no p light, phase angle twice that.
  EXPECT_NEAR(facet_diattenuation(directions(53.2671733355106, 53.2671733355106, 180.0), 1.34), 1.0, 1e-12);
  EXPECT_NEAR(facet_diattenuation(directions(0.0, 0.0, 0.0), 1.34), 0.0, 1e-12);
}

// The simulator's Mueller calculus is the truth: whatever the plane of the lamp, its part is what the two components
// say.
TEST(ChainTerms, PolarisationByFacetsTurnsWithThePlaneOfEachGeometry) {
  constexpr double kDegree = 0.01;
  constexpr double kIndex = 1.34;
  const std::vector<reflectance::SurfaceTerm> glint = {
      {.surface = reflectance::make_surface("cox_munk", {{"wind_m_per_s", 10.0}, {"refractive_index", 1.34}}).value(),
       .weight = 1.0}};
  for (const Geometry& g :
       {directions(30.0, 40.0, 180.0), directions(30.0, 40.0, 120.0), directions(50.0, 20.0, 65.0)}) {
    const double c = facet_diattenuation(g, kIndex);
    const PlaneTurn lamp = facet_turn(g.theta_i, g.theta_r, g.phi_r - g.phi_i);
    const PlaneTurn eye = facet_turn(g.theta_r, g.theta_i, g.phi_i - g.phi_r);
    const auto i = reflectance::Direction::from_angles(g.theta_i, g.phi_i);
    const auto r = reflectance::Direction::from_angles(g.theta_r, g.phi_r);
    const double plain = glint.front().surface.eval(i, r).si();
    for (const double psi_deg : {0.0, 25.0, 45.0, 110.0}) {
      const double psi2 = 2.0 * degrees(psi_deg).si();
      const sim::PolarisationSpec by_lamp{.source_degree = kDegree, .source_plane = degrees(psi_deg)};
      const sim::PolarisationSpec by_eye{.detector_diattenuation = kDegree, .detector_plane = degrees(psi_deg)};
      const auto seen = [&](const sim::PolarisationSpec& spec) {
        return sim::PolarisedSample(spec, glint).seen(i, r, sim::polarisation_axes(spec, g)).si() / plain - 1.0;
      };
      EXPECT_NEAR(seen(by_lamp), kDegree * c * (lamp.cosine * std::cos(psi2) + lamp.sine * std::sin(psi2)), 1e-12);
      EXPECT_NEAR(seen(by_eye), kDegree * c * (eye.cosine * std::cos(psi2) + eye.sine * std::sin(psi2)), 1e-12);
    }
  }
}

TEST(ChainTerms, WhatTheReadingsDoNotResolveHasASizeAndNoKnownSign) {
  InstrumentModel model = quiet();
  model.angles.u_zero_theta_r = degrees(0.1);
  model.lamp.u_after_monitor = 1e-3;
  model.cones = ConeModel{.source_half = {degrees(3.0), degrees(0.1)}, .detector_half = {degrees(2.0), Angle{}}};

  const CalibratedScan scan = calibrated(grid_of(flat_white).scan(), model);

  const auto is_known = [&](std::string_view start) {
    for (const Component& c : scan.components) {
      if (c.name.starts_with(start)) return c.is_pattern_known;
    }
    ADD_FAILURE() << "no " << start;
    return false;
  };
  for (const char* name : {"certificate", "zero theta_r", "half angle of the source's cone"}) {
    EXPECT_TRUE(is_known(name)) << name;
  }
  for (const char* name :
       {"zero theta_r through unresolved slopes", "lamp after the monitor", "cones through unresolved curvature"}) {
    EXPECT_FALSE(is_known(name)) << name;
  }
}

TEST(ChainTerms, WavelengthIsTheDifferenceQuotientOverItsNeighbours) {
  ReferenceText text;
  text.certificate += "longest_gap_nm = 60.0\n";
  text.entries =
      "[[certificate.entries]]\nwavelength_nm = 540.0\nreflectance = 0.98\nuncertainty = 0.006\n"
      "[[certificate.entries]]\nwavelength_nm = 590.0\nreflectance = 0.98\nuncertainty = 0.006\n";
  const auto standard = ReferenceStandard::parse(text.text(), "white.toml");
  ASSERT_TRUE(standard) << describe(standard.error());
  ScanBuilder builder({0.02, 0.01});
  builder.add_dark(0.0);
  for (const double nm : {550.0, 560.0, 570.0}) {
    const auto point = builder.add_point(kCentre, nanometres(nm));
    const double f = 0.2 + 1e-3 * (nm - 560.0) + 2e-5 * (nm - 560.0) * (nm - 560.0);
    builder.add_item(Target::Sample, point, nm, 0.02, plain(f, kCentre, 0.02, Target::Sample));
    builder.add_item(Target::Reference, point, nm + 1.0, 0.01, plain(0.98 / kPi, kCentre, 0.01, Target::Reference));
  }
  builder.add_dark(600.0);
  InstrumentModel model = quiet();
  model.spectral = SpectralModel{.u_centroid = nanometres(0.5), .bandwidth = nanometres(10.0)};

  const auto scan = calibrate(builder.scan(), model, *standard, kToday);

  ASSERT_TRUE(scan) << describe(scan.error());
  EXPECT_NEAR(term(*scan, "wavelength of 560 nm", 1), 1e-3 * 0.5, 1e-9);
  EXPECT_NEAR(term(*scan, "bandwidth at 560 nm", 1), 4e-5 * 100.0 / 24.0, 1e-9);
  EXPECT_NEAR(term(*scan, "wavelength of 570 nm", 2), (1e-3 + 4e-5 * 10.0) * 0.5, 1e-9) << "at an end";
}

}  // namespace
}  // namespace gonio::calibration
