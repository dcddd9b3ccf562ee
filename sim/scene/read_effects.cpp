#include "sim/scene/read_effects.h"

#include <array>
#include <string>

namespace gonio::sim {
namespace {

using stage::Axis;

constexpr std::array kAngles{Axis::ThetaI, Axis::ThetaR, Axis::PhiR, Axis::PhiI};
constexpr NumberRange kFraction{.least = 0.0, .most = 1.0};
constexpr NumberRange kSize{.least = 0.01, .most = 1000.0, .unit = "mm"};
constexpr NumberRange kSeconds{.least = 1.0, .most = 1e7, .unit = "s"};

Angle angle_or(TomlReader& t, std::string_view key, Angle fallback, double most_deg) {
  return degrees(t.number_or(key, in_degrees(fallback), {.least = -most_deg, .most = most_deg, .unit = "deg"}));
}

ConeSpec read_cones(TomlReader t) {
  constexpr NumberRange kHalf{.least = 0.0, .most = 20.0, .unit = "deg"};
  ConeSpec cones;
  cones.source_half = degrees(t.number_or("source_half_deg", 0.0, kHalf));
  cones.detector_half = degrees(t.number_or("detector_half_deg", 0.0, kHalf));
  cones.tolerance = t.number_or("tolerance", cones.tolerance, {.least = 1e-9, .most = 0.1});
  return cones;
}

OverlapSpec read_overlap(TomlReader t) {
  OverlapSpec overlap;
  overlap.spot_radius = millimetres(t.number("spot_radius_mm", kSize));
  overlap.field_radius = millimetres(t.number("field_radius_mm", kSize));
  if (const auto r = t.optional_number("sample_radius_mm", kSize)) overlap.sample_radius = millimetres(*r);
  if (const auto r = t.optional_number("reference_radius_mm", kSize)) overlap.reference_radius = millimetres(*r);
  return overlap;
}

StopSpec read_stop(TomlReader t) {
  constexpr NumberRange kDoubt{.least = 0.0, .most = 100.0, .unit = "mm"};
  constexpr NumberRange kFar{.least = 100.0, .most = 1e5, .unit = "mm"};
  return {
      .radius = {millimetres(t.number("radius_mm", kSize)), millimetres(t.number_or("u_radius_mm", 0.0, kDoubt))},
      .distance = {millimetres(t.number("distance_mm", kFar)), millimetres(t.number_or("u_distance_mm", 0.0, kDoubt))}};
}

MountSpec read_mount(TomlReader t) {
  constexpr double kMostLean = 20.0;
  MountSpec mount;
  mount.lean_0 = angle_or(t, "lean_to_phi_0_deg", {}, kMostLean);
  mount.lean_90 = angle_or(t, "lean_to_phi_90_deg", {}, kMostLean);
  mount.height = millimetres(t.number_or("height_mm", 0.0, {.least = -50.0, .most = 50.0, .unit = "mm"}));
  return mount;
}

MountingSpec read_mounting(TomlReader t) {
  constexpr NumberRange kFar{.least = 100.0, .most = 1e5, .unit = "mm"};
  MountingSpec mounting;
  if (auto sample = t.optional_table("sample")) mounting.sample = read_mount(*sample);
  if (auto reference = t.optional_table("reference")) mounting.reference = read_mount(*reference);
  const auto distance = [&](std::string_view key, Length fallback) {
    return millimetres(t.number_or(key, in_millimetres(fallback), kFar));
  };
  mounting.source_distance = distance("source_distance_mm", mounting.source_distance);
  mounting.detector_distance = distance("detector_distance_mm", mounting.detector_distance);
  return mounting;
}

PeriodicError read_periodic(TomlReader t) {
  PeriodicError error;
  error.amplitude = degrees(t.number("amplitude_deg", {.least = 0.0, .most = 5.0, .unit = "deg"}));
  error.period = degrees(t.number_or("period_deg", 360.0, {.least = 0.01, .most = 360.0, .unit = "deg"}));
  error.phase = angle_or(t, "phase_deg", {}, 360.0);
  return error;
}

PolarisationSpec read_polarisation(TomlReader t) {
  PolarisationSpec polarisation;
  polarisation.source_degree = t.number_or("source_degree", 0.0, kFraction);
  polarisation.source_plane = angle_or(t, "source_plane_deg", {}, 180.0);
  polarisation.detector_diattenuation = t.number_or("detector_diattenuation", 0.0, kFraction);
  polarisation.detector_plane = angle_or(t, "detector_plane_deg", {}, 180.0);
  return polarisation;
}

StraySpec read_stray(TomlReader t) {
  StraySpec stray;
  stray.ambient_electrons_per_s = t.number_or("ambient_electrons_per_s", 0.0, {.least = 0.0, .most = 1e9});
  stray.source_share = t.number_or("source_share", 0.0, kFraction);
  stray.internal_share = t.number_or("internal_share", 0.0, kFraction);
  return stray;
}

ResponseSpec read_response(TomlReader t) {
  constexpr NumberRange kBend{.least = -0.2, .most = 0.2};
  ResponseSpec response;
  response.quadratic = t.number_or("quadratic", 0.0, kBend);
  response.cubic = t.number_or("cubic", 0.0, kBend);
  response.knee = t.optional_number("knee", {.least = 0.1, .most = 1.5, .unit = "of full scale"});
  response.saturation =
      t.number_or("saturation", response.knee.value_or(0.0) + 0.1,
                  {.least = response.knee.value_or(0.0) + 1e-3, .most = 2.0, .unit = "of full scale"});
  return response;
}

DarkDriftSpec read_dark_drift(TomlReader t) {
  DarkDriftSpec drift;
  drift.per_hour = t.number_or("per_hour", 0.0, {.least = -1.0, .most = 10.0});
  drift.wander = t.number_or("wander", 0.0, kFraction);
  drift.offset_dn_per_hour = t.number_or("offset_dn_per_hour", 0.0, {.least = -100.0, .most = 100.0, .unit = "DN"});
  drift.offset_wander_dn = t.number_or("offset_wander_dn", 0.0, {.least = 0.0, .most = 50.0, .unit = "DN"});
  drift.correlation_s = t.number_or("correlation_s", drift.correlation_s, kSeconds);
  drift.temperature_swing_k = t.number_or("temperature_swing_k", 0.0, {.least = 0.0, .most = 30.0, .unit = "K"});
  drift.temperature_period_s = t.number_or("temperature_period_s", drift.temperature_period_s, kSeconds);
  drift.doubling_k = t.number_or("doubling_k", drift.doubling_k, {.least = 1.0, .most = 100.0, .unit = "K"});
  return drift;
}

SpeckleSpec read_speckle(TomlReader t) {
  SpeckleSpec speckle;
  speckle.contrast = t.number("contrast", kFraction);
  speckle.grain_px = static_cast<int>(t.integer_or("grain_px", speckle.grain_px, 1, 64));
  speckle.cell = degrees(t.number_or("cell_deg", in_degrees(speckle.cell), {.least = 0.001, .most = 10.0}));
  return speckle;
}

void read_encoder(TomlReader t, EffectsSpec& effects) {
  for (const Axis axis : kAngles) {
    if (auto table = t.optional_table(stage::axis_name(axis)))
      effects.encoder[stage::index_of(axis)] = read_periodic(*table);
  }
}

void read_backlash(TomlReader t, StageSpec& stage) {
  for (const Axis axis : stage::kAllAxes) {
    const std::string unit(stage::axis_unit(axis));
    const std::string key = std::string(stage::axis_name(axis)) + "_" + unit;
    stage.axes[stage::index_of(axis)].backlash = t.number_or(key, 0.0, {.least = 0.0, .most = 5.0, .unit = unit});
  }
}

}  // namespace

void read_effects(TomlReader table, Scene& scene) {
  EffectsSpec& effects = scene.effects;
  if (auto t = table.optional_table("cones")) effects.cones = read_cones(*t);
  if (auto t = table.optional_table("overlap")) effects.overlap = read_overlap(*t);
  if (auto t = table.optional_table("stop")) effects.stop = read_stop(*t);
  if (effects.stop && !effects.overlap) {
    table.fail("stop", ErrorCode::MissingKey, "nothing says how wide the beam is", "[effects.overlap] beside it");
  }
  if (auto t = table.optional_table("mounting")) effects.mounting = read_mounting(*t);
  if (auto t = table.optional_table("encoder")) read_encoder(*t, effects);
  if (auto t = table.optional_table("backlash")) read_backlash(*t, scene.stage);
  if (auto t = table.optional_table("polarisation")) effects.polarisation = read_polarisation(*t);
  if (auto t = table.optional_table("stray")) effects.stray = read_stray(*t);
  if (auto t = table.optional_table("response")) effects.response = read_response(*t);
  if (auto t = table.optional_table("dark_drift")) effects.dark_drift = read_dark_drift(*t);
  if (auto t = table.optional_table("speckle")) scene.detector.speckle = read_speckle(*t);
  const double shortest = scene.detector.shortest_exposure_s;
  effects.exposure_offset_s =
      table.number_or("exposure_offset_s", 0.0, {.least = -0.9 * shortest, .most = 1.0, .unit = "s"});
}

void read_told(TomlReader t, ToldSpec& told) {
  const auto share = [&](std::string_view key) { return t.optional_number(key, kFraction); };
  const auto angle = [&](std::string_view key) -> std::optional<Angle> {
    const auto value = t.optional_number(key, {.least = 0.0, .most = 5.0, .unit = "deg"});
    return value ? std::optional<Angle>(degrees(*value)) : std::nullopt;
  };
  told.u_linearity = share("u_linearity");
  told.exposure_offset_s = t.number_or("exposure_offset_s", 0.0, {.least = -1.0, .most = 1.0, .unit = "s"});
  told.u_exposure_offset_s = t.number_or("u_exposure_offset_s", 0.0, {.least = 0.0, .most = 1.0, .unit = "s"});
  told.u_dark_drift_dn_per_s = t.number_or("u_dark_drift_dn_per_s", 0.0, {.least = 0.0, .most = 1e4});
  told.u_zero_theta_i = angle("u_zero_theta_i_deg");
  told.u_zero_theta_r = angle("u_zero_theta_r_deg");
  told.u_zero_phi_r = angle("u_zero_phi_r_deg");
  told.u_repeat = angle("u_repeat_deg");
  told.u_after_monitor = share("u_after_monitor");
  told.u_reproducibility = share("u_reproducibility");
  constexpr NumberRange kHalf{.least = 0.0, .most = 20.0, .unit = "deg"};
  told.source_half_cone = degrees(t.number_or("source_half_cone_deg", 0.5, kHalf));
  told.detector_half_cone = degrees(t.number_or("detector_half_cone_deg", 0.5, kHalf));
}

}  // namespace gonio::sim
