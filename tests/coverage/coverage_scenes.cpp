// The scenes of the coverage test. What a scene draws and what it tells come from the same constants.
#include <utility>

#include "tests/coverage/coverage_scene.h"

namespace gonio::coverage {
namespace {

using calibration::InstrumentModel;
using sim::Chance;
using sim::Scene;

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
  list.push_back({.name = "unseen_drift",
                  .what = "20 % an hour, not seen by the monitor, visits of the standard",
                  .file = "wheat",
                  .first_seed = 14'000'000,
                  .plan = blind,
                  .bend = quiet,
                  .draw = [](Scene& s, Chance& chance) { s.lamp.drift_per_hour = 0.2 * chance.normal(); }});
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
  constexpr double kResidual = 0.002;
  list.push_back({.name = "nonlinear",
                  .what = "camera that bends by 2 %, its curve known to 0.2 %",
                  .file = "wheat",
                  .first_seed = 16'000'000,
                  .plan = small_plan(),
                  .bend =
                      [](Scene& s) {
                        s.detector.u_linearity = kResidual;
                        s.effects.response.emplace();
                        s.effects.response->quadratic = -0.02;
                      },
                  .fails_for = "no curve of the detector's linearity can be told"});
  constexpr double kT0 = 4e-4;
  constexpr double kUT0 = 5e-5;
  list.push_back({.name = "exposure_offset",
                  .what = "shutter open 0.4 ms longer than it says, known to 0.05 ms",
                  .file = "dark",
                  .first_seed = 17'000'000,
                  .bend =
                      [](Scene& s) {
                        brighten(s, 100.0);
                        s.told.exposure_offset_s = kT0;
                        s.told.u_exposure_offset_s = kUT0;
                      },
                  .draw = [](Scene& s,
                             Chance& chance) { s.effects.exposure_offset_s = kT0 + kUT0 * chance.normal(); }});
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
  constexpr Angle kLean = degrees(0.1);
  constexpr Length kHeight = millimetres(0.3);
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
                  .fails_for = "tilt and height of a mount are not in the budget"});
  list.push_back({.name = "wide_cones",
                  .what = "source and detector of 3 deg half angle",
                  .file = "wheat",
                  .first_seed = 24'000'000,
                  .plan = small_plan(),
                  .bend =
                      [](Scene& s) {
                        s.effects.cones = {
                            .source_half = degrees(3.0), .detector_half = degrees(3.0), .tolerance = 1e-4};
                      },
                  .fails_for = "finite cones are not in the budget"});
  list.push_back({.name = "polarised",
                  .what = "source and detector polarise by 5 %, a glint",
                  .file = "glint",
                  .first_seed = 25'000'000,
                  .plan = through_the_mirror_direction(),
                  .has_lobe = true,
                  .draw =
                      [](Scene& s, Chance& chance) {
                        s.effects.polarisation = {.source_degree = 0.05,
                                                  .source_plane = degrees(180.0 * chance.uniform()),
                                                  .detector_diattenuation = 0.05,
                                                  .detector_plane = degrees(180.0 * chance.uniform())};
                      },
                  .fails_for = "polarisation is not in the budget"});
  list.push_back({.name = "stray",
                  .what = "black, room light and stray light of the lamp",
                  .file = "dark",
                  .first_seed = 26'000'000,
                  .bend =
                      [](Scene& s) {
                        s.effects.stray = {
                            .ambient_electrons_per_s = 50.0, .source_share = 1e-4, .internal_share = 0.0};
                      },
                  .fails_for = "neither ambient nor stray light is subtracted"});
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
  return list;
}

}  // namespace gonio::coverage
