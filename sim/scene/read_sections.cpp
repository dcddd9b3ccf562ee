#include "sim/scene/read_sections.h"

#include <array>
#include <string>
#include <string_view>

#include "sim/scene/read_effects.h"

#include "sim/scene/read_kinematics.h"

namespace gonio::sim {
namespace {

using stage::Axis;

constexpr NumberRange kPositive{.least = 1e-12};
constexpr NumberRange kNotNegative{.least = 0.0};
constexpr NumberRange kShare{.least = 0.0, .most = 1.0};

void read_lamp(TomlReader t, LampSpec& lamp) {
  lamp.power = t.number("power", kPositive);
  lamp.drift_per_hour = t.number_or("drift_per_hour", 0.0);
  lamp.wave = t.number_or("wave", 0.0, {.least = 0.0, .most = 0.5});
  lamp.wave_period_s = t.number_or("wave_period_s", lamp.wave_period_s, kPositive);
  lamp.flicker = t.number_or("flicker", 0.0, {.least = 0.0, .most = 0.1});
  lamp.flicker_cell_s = t.number_or("flicker_cell_s", lamp.flicker_cell_s, {.least = 1e-3, .unit = "s"});
  lamp.monitor_noise = t.number_or("monitor_noise", 0.0, {.least = 0.0, .most = 0.1});
  lamp.monitor_rate_hz = t.number_or("monitor_rate_hz", lamp.monitor_rate_hz, {.least = 1.0, .unit = "Hz"});
  lamp.u_after_monitor = t.number_or("u_after_monitor", 0.0, kShare);
  lamp.correlation_s = t.number_or("correlation_s", lamp.correlation_s, kPositive);
  lamp.u_reproducibility = t.number_or("u_reproducibility", 0.0, kShare);
}

struct SentPixels {
  std::string_view name;
  int bits;
};
constexpr std::array<SentPixels, 9> kSentPixels{{{"Mono8", 8},
                                                 {"Mono10", 10},
                                                 {"Mono12", 12},
                                                 {"Mono14", 14},
                                                 {"Mono16", 16},
                                                 {"Mono10Packed", 10},
                                                 {"Mono12Packed", 12},
                                                 {"Mono10p", 10},
                                                 {"Mono12p", 12}}};
constexpr std::size_t kUsualPixels = 2;
constexpr auto kPixelFormatNames = [] {
  std::array<std::string_view, kSentPixels.size()> names;
  for (std::size_t k = 0; k < names.size(); ++k) names[k] = kSentPixels[k].name;
  return names;
}();
constexpr std::array<std::string_view, 2> kTemperatureSensors{"housing", "none"};

void read_detector(TomlReader t, DetectorSpec& detector) {
  detector.serial = t.text_or("serial", detector.serial);
  const SentPixels& sent = kSentPixels[t.choice_or("pixel_format", kUsualPixels, kPixelFormatNames)];
  detector.pixel_format = sent.name;
  detector.bits = sent.bits;
  detector.has_temperature = t.choice_or("temperature", 0, kTemperatureSensors) == 0;
  detector.flat_sigma = t.number_or("flat_sigma", 0.0, {.least = 0.0, .most = 0.3});
  detector.bad_fraction = t.number_or("bad_fraction", 0.0, {.least = 0.0, .most = 0.5});
  detector.width_px = static_cast<int>(t.integer_or("width_px", 64, 16, 1024));
  detector.height_px = static_cast<int>(t.integer_or("height_px", 64, 16, 1024));
  detector.electrons_per_s = t.number("electrons_per_s", kPositive);
  detector.electrons_per_dn = t.number("electrons_per_dn", kPositive);
  detector.read_noise_dn = t.number_or("read_noise_dn", 0.0, kNotNegative);
  detector.dark_dn_per_s = t.number_or("dark_dn_per_s", 0.0, kNotNegative);
  detector.offset_dn = t.number_or("offset_dn", 0.0, {.least = 0.0, .most = 1000.0, .unit = "DN"});
  detector.u_linearity = t.number_or("u_linearity", 0.0, {.least = 0.0, .most = 0.1});
  detector.spot_radius_px = t.number_or("spot_radius_px", detector.spot_radius_px, kPositive);
  const NumberRange inside_spot{
      .least = 1.0, .most = detector.spot_radius_px, .unit = "px, the radius of the lit spot"};
  detector.aperture_radius_px = t.number_or("aperture_radius_px", detector.aperture_radius_px, inside_spot);
  detector.shortest_exposure_s = t.number_or("shortest_exposure_s", detector.shortest_exposure_s, kPositive);
  detector.longest_exposure_s = t.number_or("longest_exposure_s", detector.longest_exposure_s,
                                            {.least = detector.shortest_exposure_s, .unit = "s"});
  detector.frames_at_most = static_cast<int>(t.integer_or("frames_at_most", detector.frames_at_most, 1, 10000));
  detector.control_heartbeat_wall_s = t.number_or("control_heartbeat_wall_s", detector.control_heartbeat_wall_s,
                                                  {.least = 0.5, .most = 60.0, .unit = "s"});
}

void read_axis(TomlReader t, Axis axis, AxisSpec& spec) {
  const std::string unit(stage::axis_unit(axis));
  spec.low = t.number("low_" + unit);
  spec.high = t.number("high_" + unit, {.least = spec.low});
  spec.speed = t.number("speed_" + unit + "_per_s", kPositive);
  spec.acceleration = t.number("acceleration_" + unit + "_per_s2", kPositive);
  spec.settle_s = t.number_or("settle_s", 0.0, kNotNegative);
  spec.window = t.number("window_" + unit, kPositive);
}

void read_stage(TomlReader t, StageSpec& spec) {
  spec.shutter_s = t.number_or("shutter_s", 0.0, kNotNegative);
  spec.following_error_s = t.number_or("following_error_s", spec.following_error_s, kPositive);
  spec.heartbeat_timeout_wall_s = t.number_or("heartbeat_timeout_wall_s", spec.heartbeat_timeout_wall_s,
                                              {.least = 0.01, .most = 60.0, .unit = "s"});
  spec.registers = stage::own_register_map();
  TomlReader axes = t.table("axes");
  for (const Axis axis : stage::kAllAxes)
    read_axis(axes.table(stage::axis_name(axis)), axis, spec.axes[stage::index_of(axis)]);
  if (auto kinematics = t.optional_table("kinematics")) read_kinematics(*std::move(kinematics), spec);
  TomlReader carriage = t.table("carriage");
  const AxisSpec& rail = spec.axes[stage::index_of(Axis::Carriage)];
  const NumberRange on_the_rail{.least = rail.low, .most = rail.high, .unit = "mm"};
  spec.sample_mm = carriage.number("sample_mm", on_the_rail);
  spec.reference_mm = carriage.number("reference_mm", on_the_rail);
  spec.trap_mm = carriage.number("trap_mm", on_the_rail);
  spec.open_mm = carriage.optional_number("open_mm", on_the_rail);
}

void read_angles(TomlReader t, AngleSpec& angles) {
  const NumberRange small{.least = 0.0, .most = 5.0, .unit = "deg"};
  angles.u_zero_theta_i = degrees(t.number_or("u_zero_theta_i_deg", 0.0, small));
  angles.u_zero_theta_r = degrees(t.number_or("u_zero_theta_r_deg", 0.0, small));
  angles.u_zero_phi_r = degrees(t.number_or("u_zero_phi_r_deg", 0.0, small));
  angles.u_repeat = degrees(t.number_or("u_repeat_deg", 0.0, small));
}

ShapeMode read_mode(TomlReader t) {
  static constexpr std::array<std::string_view, 4> kKinds{"limb", "forward", "sideways", "opposition"};
  ShapeMode mode;
  mode.kind = static_cast<ModeKind>(t.choice("kind", kKinds));
  mode.u = t.number("u", kShare);
  if (mode.kind == ModeKind::Opposition) mode.width = degrees(t.number("width_deg", {.least = 0.1, .most = 90.0}));
  return mode;
}

void read_reference(TomlReader t, ReferenceSpec& reference) {
  reference.serial = t.text_or("serial", reference.serial);
  reference.material = t.text_or("material", reference.material);
  if (t.kind("date") != TomlKind::Absent) reference.certificate_date = t.date("date");
  if (t.kind("expires") != TomlKind::Absent) reference.expires = t.date("expires");
  reference.coverage_factor = t.number("coverage_factor", {.least = 1.0, .most = 4.0});
  reference.u_integral = t.number_or("u_integral", 0.0, kShare);
  for (TomlReader& entry : t.tables("certificate")) {
    reference.certificate.push_back(
        {.wavelength = nanometres(entry.number("wavelength_nm", {.least = 200.0, .unit = "nm"})),
         .reflectance = entry.number("reflectance", kShare),
         .uncertainty = entry.number("uncertainty", kShare)});
  }
  if (reference.certificate.empty())
    t.fail("certificate", ErrorCode::MissingKey, "no entry", "at least one wavelength");
  for (std::size_t k = 1; k < reference.certificate.size(); ++k) {
    if (reference.certificate[k - 1].wavelength < reference.certificate[k].wavelength) continue;
    t.fail("certificate", ErrorCode::InvalidInput, "wavelengths out of order", "ascending wavelengths");
  }
  for (TomlReader& mode : t.tables("modes")) reference.modes.push_back(read_mode(mode));
}

void read_environment(TomlReader t, EnvironmentSpec& environment) {
  const NumberRange liveable{.least = -50.0, .most = 200.0, .unit = "deg C"};
  environment.lamp = celsius(t.number_or("lamp_c", in_celsius(environment.lamp), liveable));
  environment.detector = celsius(t.number_or("detector_c", in_celsius(environment.detector), liveable));
  environment.room = celsius(t.number_or("room_c", in_celsius(environment.room), liveable));
  environment.humidity_percent =
      t.number_or("humidity_percent", environment.humidity_percent, {.least = 0.0, .most = 100.0});
}

FilterSpec read_filter(TomlReader t) {
  FilterSpec filter;
  filter.slot = static_cast<int>(t.integer("slot", 1, 32));
  filter.centroid = nanometres(t.number("centroid_nm", {.least = 200.0, .most = 3000.0, .unit = "nm"}));
  filter.fwhm = nanometres(t.number("fwhm_nm", kPositive));
  filter.transmission = t.number_or("transmission", 1.0, kShare);
  filter.out_of_band_fraction = t.number_or("out_of_band_fraction", 0.0, kShare);
  if (const auto passed = t.optional_number("attenuation", {.least = 1e-9, .most = 1.0})) {
    filter.attenuation = Measured<double>{*passed, t.number_or("u_attenuation", 0.0, {.least = 0.0, .most = *passed})};
  }
  return filter;
}

// The text that has the section: the scene's own first. Without either, the scene's, so that the error names it.
TomlReader& holder(TomlReader& own, TomlReader* bench, std::string_view section) {
  // Asking both makes the key known in both: a bench's section that a scene replaces is no stray.
  const bool in_own = own.kind(section) != TomlKind::Absent;
  const bool in_bench = bench != nullptr && bench->kind(section) != TomlKind::Absent;
  return !in_own && in_bench ? *bench : own;
}

}  // namespace

void read_sections(TomlReader& own, TomlReader* bench, Scene& scene) {
  const auto from = [&](std::string_view section) -> TomlReader& { return holder(own, bench, section); };
  read_lamp(from("source").table("source"), scene.lamp);
  read_detector(from("detector").table("detector"), scene.detector);
  read_stage(from("stage").table("stage"), scene.stage);
  read_reference(from("reference").table("reference"), scene.reference);
  if (auto t = from("angles").optional_table("angles")) read_angles(*t, scene.angles);
  if (auto t = from("environment").optional_table("environment")) read_environment(*t, scene.environment);
  read_radiometers(from("radiometers"), scene);
  if (auto t = from("effects").optional_table("effects")) read_effects(*t, scene);
  if (auto t = from("told").optional_table("told")) read_told(*t, scene.told);
  TomlReader& filters = from("filters");
  for (TomlReader& t : filters.tables("filters")) scene.filters.push_back(read_filter(t));
  if (scene.filters.empty()) filters.fail("filters", ErrorCode::MissingKey, "no [[filters]]", "at least one filter");
}

}  // namespace gonio::sim
