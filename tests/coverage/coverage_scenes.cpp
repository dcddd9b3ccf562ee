// The scenes of the coverage test. What a scene draws and what it tells come from the same constants.
#include <cmath>
#include <optional>
#include <utility>

#include "tests/coverage/coverage_scene.h"

namespace gonio::coverage {
namespace {

using calibration::InstrumentModel;
using sim::Chance;
using sim::Scene;

// Standard uncertainties of leans and heights; half angles of the cones; radii of spot and field, relative u.
constexpr Angle kLean = degrees(0.1);
constexpr Length kHeight = millimetres(0.3);
constexpr Angle kCone = degrees(3.0);
constexpr Angle kUCone = degrees(0.1);
constexpr Length kSpot = millimetres(10.0);
constexpr Length kField = millimetres(3.0);
constexpr double kRelative = 0.005;

ScanPlan small_plan() {
  ScanPlan plan;
  plan.theta_i_deg = {15.0, 50.0};
  plan.theta_r_deg = {0.0, 25.0, 50.0, 70.0};
  plan.phi_r_deg = {0.0, 60.0, 120.0, 180.0};
  return plan;
}

ScanPlan between_the_nodes() {
  ScanPlan plan;
  plan.theta_i_deg = {7.0, 33.0, 58.0};
  plan.theta_r_deg = {2.0, 17.0, 32.0, 47.0, 63.5, 76.0};
  plan.phi_r_deg = {4.0, 63.0, 123.0, 176.0};
  return plan;
}

// The lobe of a glint and that of a hot spot: lines that a spectrometrist would lay through them.
ScanPlan through_the_mirror_direction() {
  ScanPlan plan;
  plan.theta_i_deg = {25.0, 30.0, 35.0};
  plan.theta_r_deg = {15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 60.0};
  plan.phi_r_deg = {90.0, 165.0, 180.0};
  return plan;
}

// Few readings: an average over cones costs the simulator a thousand evaluations.
ScanPlan coarse_lobe() {
  ScanPlan plan;
  plan.theta_i_deg = {25.0, 30.0, 35.0};
  plan.theta_r_deg = {20.0, 25.0, 30.0, 35.0, 40.0, 45.0};
  plan.phi_r_deg = {170.0, 180.0};
  plan.frames = 1;
  plan.exposure_s = 0.016;
  return plan;
}

ScanPlan through_the_retro_direction() {
  ScanPlan plan;
  plan.theta_i_deg = {25.0, 30.0, 35.0};
  plan.theta_r_deg = {0.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 60.0};
  plan.phi_r_deg = {0.0, 15.0, 90.0};
  return plan;
}

void brighten(Scene& scene, double factor) {
  for (auto& term : scene.sample) term.weight *= factor;
}

void add_matt_scenes(std::vector<CoverageScene>& list) {
  list.push_back({.name = "lambertian", .what = "matt grey card", .file = "lambertian", .first_seed = 1'000'000});
  list.push_back({.name = "minnaert", .what = "limb darkened", .file = "minnaert", .first_seed = 2'000'000});
  list.push_back({.name = "hapke", .what = "bright particles", .file = "hapke", .first_seed = 3'000'000});
  list.push_back({.name = "rpv", .what = "soil", .file = "rpv", .first_seed = 4'000'000});
  list.push_back({.name = "wheat", .what = "canopy", .file = "wheat", .first_seed = 5'000'000});
  list.push_back({.name = "between_nodes",
                  .what = "canopy, off the nodes of the reference's table",
                  .file = "wheat",
                  .first_seed = 6'000'000,
                  .plan = between_the_nodes()});
}

void add_peaked_scenes(std::vector<CoverageScene>& list) {
  list.push_back({.name = "glint",
                  .what = "glint of a rough sea",
                  .file = "glint",
                  .first_seed = 7'000'000,
                  .plan = through_the_mirror_direction(),
                  .has_lobe = true});
  list.push_back({.name = "hot_spot",
                  .what = "a sharp peak at retro-reflection",
                  .file = "hot-spot",
                  .first_seed = 8'000'000,
                  .plan = through_the_retro_direction(),
                  .has_lobe = true});
}

void add_dark_scenes(std::vector<CoverageScene>& list) {
  list.push_back({.name = "dark", .what = "black, rho = 0.0002", .file = "dark", .first_seed = 9'000'000});
  list.push_back({.name = "below_noise",
                  .what = "a thousandth of that: values of both signs",
                  .file = "dark",
                  .first_seed = 10'000'000,
                  .bend = [](Scene& s) { brighten(s, 1e-3); }});
  ScanPlan wandering;
  wandering.u_dark_drift_dn_per_s = 0.1;
  list.push_back({.name = "dark_drift",
                  .what = "black, a dark that wanders between its visits",
                  .file = "dark",
                  .first_seed = 11'000'000,
                  .plan = wandering});
  ScanPlan few;
  few.frames = 5;
  list.push_back({.name = "few_repeats",
                  .what = "noise from the scatter of 5 frames, not from a model",
                  .file = "dark",
                  .first_seed = 12'000'000,
                  .plan = few,
                  .bend = [](Scene& s) { brighten(s, 10.0); },
                  .tell = [](InstrumentModel& m) { m.detector.noise = calibration::NoiseSource::RepeatedFrames; }});
}

void add_lamp_scenes(std::vector<CoverageScene>& list) {
  list.push_back({.name = "drifted_lamp",
                  .what = "lamp that ages 15 % an hour and swings by 4 %, seen by the monitor",
                  .file = "drifted-lamp",
                  .first_seed = 13'000'000});
  const auto quiet = [](Scene& s) {
    s.lamp.drift_per_hour = s.lamp.wave = s.lamp.flicker = s.lamp.u_after_monitor = 0.0;
  };
  ScanPlan blind;
  blind.monitor_is_blind = blind.visits = true;
  blind.block = 5;
  list.push_back({.name = "unseen_drift",
                  .what = "response that drifts by 1.7 % a minute, not seen by the monitor, visits of the standard",
                  .file = "wheat",
                  .first_seed = 14'000'000,
                  .plan = blind,
                  .bend = quiet,
                  .draw = [](Scene& s, Chance& chance) { s.lamp.drift_per_hour = chance.normal(); }});
  ScanPlan stepping = blind;
  stepping.step = 0.01;
  list.push_back({.name = "unseen_steps",
                  .what = "steps of 1 % between visits, not seen by the monitor",
                  .file = "wheat",
                  .first_seed = 15'000'000,
                  .plan = stepping,
                  .bend = quiet});
}

void add_detector_scenes(std::vector<CoverageScene>& list) {
  // What a ladder's fit leaves: the curve's first coefficient and the shutter's offset, each taken for the other.
  constexpr double kBend = 0.02;
  constexpr double kUBend = 0.002;
  constexpr double kUOffset = 1e-5;
  constexpr double kCorrelation = -0.8;
  list.push_back({.name = "nonlinear",
                  .what = "camera that bends by 2 %, its curve and its shutter fitted together",
                  .file = "wheat",
                  .first_seed = 16'000'000,
                  .plan = small_plan(),
                  .bend = [](Scene& s) { s.detector.u_linearity = 2e-4; },
                  .draw =
                      [](Scene& s, Chance& chance) {
                        const double bend = chance.normal();
                        const double rest = std::sqrt(1.0 - kCorrelation * kCorrelation);
                        s.effects.response.emplace();
                        s.effects.response->quadratic = -(kBend + kUBend * bend);
                        s.effects.exposure_offset_s = kUOffset * (kCorrelation * bend + rest * chance.normal());
                      },
                  .tell =
                      [](InstrumentModel& m) {
                        // The inverse of y = x (1 - b x) as a series in y.
                        m.detector.linearity.coefficients = {kBend, 2.0 * kBend * kBend, 5.0 * kBend * kBend * kBend};
                        const double both = kCorrelation * kUBend * kUOffset;
                        m.detector.linearity.covariance.assign(16, 0.0);
                        m.detector.linearity.covariance[0] = kUBend * kUBend;
                        m.detector.linearity.covariance[3] = m.detector.linearity.covariance[12] = both;
                        m.detector.linearity.covariance[15] = kUOffset * kUOffset;
                      }});
  constexpr double kT0 = 4e-4;
  constexpr double kUT0 = 5e-5;
  list.push_back(
      {.name = "exposure_offset",
       .what = "shutter open 0.4 ms longer than it says, known to 0.05 ms",
       .file = "dark",
       .first_seed = 17'000'000,
       .bend =
           [](Scene& s) {
             brighten(s, 100.0);
             s.told.exposure_offset_s = kT0;
             s.told.u_exposure_offset_s = kUT0;
           },
       .draw = [](Scene& s, Chance& chance) { s.effects.exposure_offset_s = kT0 + kUT0 * chance.normal(); }});
  ScanPlan frames = small_plan();
  frames.detector = DetectorKind::Frames;
  frames.dark_frames = 1;
  list.push_back({.name = "frames",
                  .what = "canopy, every pixel drawn and reduced",
                  .file = "wheat",
                  .first_seed = 18'000'000,
                  .plan = frames});
  ScanPlan meter;
  meter.detector = DetectorKind::Radiometer;
  list.push_back({.name = "radiometer",
                  .what = "power meter with ranges in the camera's place",
                  .file = "rpv",
                  .first_seed = 19'000'000,
                  .plan = meter,
                  .bend = [](Scene& s) { s.detector.u_linearity = 0.0; }});
}

void add_reference_scenes(std::vector<CoverageScene>& list) {
  list.push_back({.name = "certificate",
                  .what = "certificate wrong within its U of 4 %",
                  .file = "wheat",
                  .first_seed = 20'000'000,
                  .bend = [](Scene& s) {
                    for (auto& entry : s.reference.certificate) entry.uncertainty = 0.04;
                  }});
  list.push_back({.name = "shape",
                  .what = "reference of another shape than its table, by four modes of 1.5 to 3 %",
                  .file = "wheat",
                  .first_seed = 21'000'000,
                  .bend = [](Scene& s) {
                    using sim::ModeKind;
                    s.reference.modes = {{.kind = ModeKind::Limb, .u = 0.03, .width = {}},
                                         {.kind = ModeKind::Forward, .u = 0.02, .width = {}},
                                         {.kind = ModeKind::Sideways, .u = 0.015, .width = {}},
                                         {.kind = ModeKind::Opposition, .u = 0.02, .width = degrees(10.0)}};
                    s.reference.u_integral = 0.005;
                  }});
}

void add_bench_scenes(std::vector<CoverageScene>& list) {
  list.push_back({.name = "poor_angles",
                  .what = "canopy, zeros of the arms known to 0.1 deg, repeated to 0.02 deg",
                  .file = "wheat",
                  .first_seed = 22'000'000,
                  .bend = [](Scene& s) {
                    s.angles.u_zero_theta_i = s.angles.u_zero_theta_r = s.angles.u_zero_phi_r = degrees(0.1);
                    s.angles.u_repeat = degrees(0.02);
                  }});
  list.push_back({.name = "tilted",
                  .what = "sample and reference askew by 0.1 deg, 0.3 mm high or low",
                  .file = "wheat",
                  .first_seed = 23'000'000,
                  .draw =
                      [](Scene& s, Chance& chance) {
                        auto& mounting = s.effects.mounting.emplace();
                        for (sim::MountSpec* mount : {&mounting.sample, &mounting.reference}) {
                          mount->lean_0 = kLean * chance.normal();
                          mount->lean_90 = kLean * chance.normal();
                          mount->height = kHeight * chance.normal();
                        }
                      },
                  .tell =
                      [](InstrumentModel& m) {
                        auto& mounting = m.mounting.emplace();
                        for (calibration::MountModel* mount : {&mounting.sample, &mounting.reference}) {
                          mount->lean_0.u = mount->lean_90.u = kLean;
                          mount->height.u = kHeight;
                        }
                      }});
  const auto draw_cones = [](Scene& s, Chance& chance) {
    s.effects.cones = sim::ConeSpec{.source_half = kCone + kUCone * chance.normal(),
                                    .detector_half = kCone + kUCone * chance.normal(),
                                    .tolerance = 3e-4};
  };
  const auto tell_cones = [](InstrumentModel& m) {
    m.cones = calibration::ConeModel{.source_half = {kCone, kUCone}, .detector_half = {kCone, kUCone}};
  };
  ScanPlan few = small_plan();
  few.frames = 1;
  few.exposure_s = 0.016;
  list.push_back({.name = "cones_matt",
                  .what = "canopy; source and detector of 3 deg half angle, known to 0.1 deg",
                  .file = "wheat",
                  .first_seed = 28'000'000,
                  .plan = few,
                  .draw = draw_cones,
                  .tell = tell_cones});
  list.push_back({.name = "wide_cones",
                  .what = "glint; source and detector of 3 deg half angle, known to 0.1 deg",
                  .file = "glint",
                  .first_seed = 24'000'000,
                  .plan = coarse_lobe(),
                  .has_lobe = true,
                  .draw = draw_cones,
                  .tell = tell_cones});
}

/// Room light, from that of `ambient` = 0 to twice as much at 1, and stray light of the lamp.
sim::StraySpec background(double ambient, double source_share) {
  return {.ambient_electrons_per_s = 50.0 * (1.0 + ambient), .source_share = source_share, .internal_share = 0.0};
}

void add_stray_scenes(std::vector<CoverageScene>& list) {
  constexpr double kDegree = 0.01;
  list.push_back(
      {.name = "polarised",
       .what = "source and detector polarise by 1 % in planes that nobody knows, a glint without the water body",
       .file = "glint",
       .first_seed = 25'000'000,
       .plan = through_the_mirror_direction(),
       .has_lobe = true,
       .bend = [](Scene& s) { s.sample.resize(1, s.sample.front()); },  // facets alone, as is told
       .draw =
           [](Scene& s, Chance& chance) {
             s.effects.polarisation = sim::PolarisationSpec{.source_degree = kDegree,
                                                            .source_plane = degrees(180.0 * chance.uniform()),
                                                            .detector_diattenuation = kDegree,
                                                            .detector_plane = degrees(180.0 * chance.uniform())};
           },
       .tell =
           [](InstrumentModel& m) {
             // The standard depolarises.
             m.polarisation = calibration::PolarisationModel{.source_degree = kDegree,
                                                             .detector_diattenuation = kDegree,
                                                             .u_sample = calibration::kOfAnyPlane,
                                                             .u_reference = 0.0,
                                                             .sample_index = 1.34};
           }});
  ScanPlan lit;
  lit.ambient_visits = true;
  list.push_back({.name = "ambient",
                  .what = "black, room light as bright as it",
                  .file = "dark",
                  .first_seed = 29'000'000,
                  .plan = lit,
                  .bend = [](Scene& s) { s.effects.stray = background(0.5, 0.0); },
                  .draw = [](Scene& s, Chance& chance) { s.effects.stray = background(chance.uniform(), 0.0); }});
  ScanPlan visited = lit;
  visited.trap_visits = true;
  list.push_back({.name = "stray",
                  .what = "black, room light and stray light of the lamp, both as bright as it",
                  .file = "dark",
                  .first_seed = 26'000'000,
                  .plan = visited,
                  .bend = [](Scene& s) { s.effects.stray = background(0.5, 1.5e-4); },
                  .draw =
                      [](Scene& s, Chance& chance) {
                        const double ambient = chance.uniform();
                        s.effects.stray = background(ambient, 1e-4 * (1.0 + chance.uniform()));
                      }});
}

void add_anchor_scenes(std::vector<CoverageScene>& list) {
  ScanPlan plan;
  plan.theta_i_deg = {0.0, 50.0};
  plan.theta_r_deg = {0.0, 20.0, 45.0, 60.0, 75.0};
  plan.phi_r_deg = {0.0, 90.0, 180.0};
  plan.visits = true;
  plan.reference_mode = calibration::ReferenceMode::Anchor;
  list.push_back({.name = "anchor",
                  .what = "the standard at 0/45 alone; spot 10 mm, field of view 3 mm, known to 0.5 %",
                  .file = "wheat",
                  .first_seed = 27'000'000,
                  .plan = plan,
                  .draw =
                      [](Scene& s, Chance& chance) {
                        s.effects.overlap =
                            sim::OverlapSpec{.spot_radius = kSpot * (1.0 + kRelative * chance.normal()),
                                             .field_radius = kField * (1.0 + kRelative * chance.normal()),
                                             .sample_radius = std::nullopt,
                                             .reference_radius = std::nullopt};
                      },
                  .tell =
                      [](InstrumentModel& m) {
                        auto& overlap = m.overlap.emplace();
                        overlap.spot_radius = {kSpot, kSpot * kRelative};
                        overlap.field_radius = {kField, kField * kRelative};
                      }});
}

}  // namespace

std::vector<CoverageScene> coverage_scenes() {
  std::vector<CoverageScene> list;
  add_matt_scenes(list);
  add_peaked_scenes(list);
  add_dark_scenes(list);
  add_lamp_scenes(list);
  add_detector_scenes(list);
  add_reference_scenes(list);
  add_bench_scenes(list);
  add_stray_scenes(list);
  add_anchor_scenes(list);
  return list;
}

}  // namespace gonio::coverage
