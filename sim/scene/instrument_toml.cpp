// The daemon's description of the instrument, section by section.
#include <fmt/format.h>

#include <cmath>

#include "sim/devices/detector_noise.h"
#include "sim/scene/papers.h"

namespace gonio::sim {

using stage::Axis;

namespace {

double wall_s(const Scene& scene, double scene_s) {
  return scene_s / scene.time_scale;
}

std::string axis_section(const Scene& scene, Axis axis) {
  const AxisSpec& spec = scene.stage.axes[stage::index_of(axis)];
  const std::string_view unit = stage::axis_unit(axis);
  const double k = scene.time_scale;
  return fmt::format(
      "\n[stage.axes.{0}]\noffset_{1} = 0.0\nlow_{1} = {2}\nhigh_{1} = {3}\nspeed_{1}_per_s = {4}\n"
      "acceleration_{1}_per_s2 = {5}\nsettle_s = {6}\nwindow_{1} = {7}\n",
      stage::axis_name(axis), unit, spec.low, spec.high, spec.speed * k, spec.acceleration * k * k,
      wall_s(scene, spec.settle_s), spec.window);
}

// The longest way of any axis at homing's half speed, twice over, and time for a machine that is busy with other
// things.
double homing_time_s(const Scene& scene) {
  constexpr double kPatience = 5.0;
  double longest = 0.0;
  for (const AxisSpec& spec : scene.stage.axes) {
    longest = std::max(longest, 2.0 * (spec.high - spec.low) / spec.speed + spec.speed / spec.acceleration);
  }
  return 2.0 * wall_s(scene, longest) + kPatience;
}

std::string stage_address_lines(const WireAddresses& addresses) {
  if (addresses.stage_line.empty()) {
    return fmt::format("link = \"tcp\"\naddress = \"{}\"\nport = {}\n", addresses.stage_host, addresses.stage_port);
  }
  return fmt::format("link = \"rtu\"\naddress = \"{}\"\nbaud = {}\nparity = \"none\"\nstop_bits = 2\n",
                     addresses.stage_line, addresses.stage_baud);
}

std::string kinematics_section(const TurningSampleSpec& sample) {
  return fmt::format(
      "\n[stage.kinematics]\nkind = \"turning-sample\"\nyaw = \"{}\"\npitch = \"{}\"\nroll = \"{}\"\n"
      "detector_arm = \"{}\"\nsource_azimuth_deg = {:.10g}\nsource_elevation_deg = {:.10g}\n"
      "detector_plane_tilt_deg = {:.10g}\n",
      stage::axis_name(sample.yaw), stage::axis_name(sample.pitch), stage::axis_name(sample.roll),
      stage::axis_name(sample.detector_arm), in_degrees(sample.source_azimuth), in_degrees(sample.source_elevation),
      in_degrees(sample.detector_plane_tilt));
}

std::string stage_section(const Scene& scene, const WireAddresses& addresses) {
  constexpr double kPatience = 2.0;
  std::string text = fmt::format(
      "\n[stage]\n{}{}reply_timeout_s = 1.0\nhoming_time_s = {:.3f}\n"
      "shutter_time_s = {:.3f}\nheartbeat_timeout_s = {}\ndeadline_factor = 1.5\ndeadline_margin_s = {}\n",
      scene.stage.drives ? "kind = \"drives\"\n" : "", stage_address_lines(addresses), homing_time_s(scene),
      2.0 * wall_s(scene, scene.stage.shutter_s) + kPatience, scene.stage.heartbeat_timeout_wall_s, kPatience);
  for (const Axis axis : stage::kAllAxes) text += axis_section(scene, axis);
  if (scene.stage.turning_sample) text += kinematics_section(*scene.stage.turning_sample);
  text += fmt::format("\n[stage.carriage]\nsample_mm = {}\nreference_mm = {}\ntrap_mm = {}\n", scene.stage.sample_mm,
                      scene.stage.reference_mm, scene.stage.trap_mm);
  if (scene.stage.open_mm) text += fmt::format("open_mm = {}\n", *scene.stage.open_mm);
  for (const FilterSpec& filter : scene.filters) {
    text += fmt::format(
        "\n[[stage.filters]]\nslot = {}\ncentroid_nm = {:.10g}\nfwhm_nm = {:.10g}\nout_of_band_fraction = {}\nside = "
        "\"detector\"\n",
        filter.slot, in_nanometres(filter.centroid), in_nanometres(filter.fwhm), filter.out_of_band_fraction);
    if (!filter.attenuation) continue;
    text += fmt::format("attenuation = {:.10g}\nu_attenuation = {:.10g}\n", filter.attenuation->value,
                        filter.attenuation->u);
  }
  text +=
      "\n[stage.shadow]\ndetector_head_radius_mm = 20.0\nsource_head_radius_mm = 20.0\ndetector_arm_mm = 500.0\n"
      "source_arm_mm = 600.0\n\n";
  if (scene.stage.drives) return text + stage::to_toml(*scene.stage.drives, "stage.drives");
  return text + stage::to_toml(scene.stage.registers, "stage.registers");
}

std::string detector_section(const Scene& scene, const WireAddresses& addresses) {
  if (std::string meter = radiometer_detector_section(scene); !meter.empty()) return meter;
  const DetectorSpec& spec = scene.detector;
  const ToldSpec& told = scene.told;
  const Aperture aperture = aperture_of(spec);
  constexpr double kRounding = 1.0 / 12.0;  // the variance of rounding to whole DN
  return fmt::format(
      "\n[detector]\nkind = \"genicam\"\naddress = \"{}\"\nserial = \"{}\"\nwidth_px = {}\nheight_px = {}\n"
      "pixel_format = \"{}\"\npacket_size_bytes = 1400\nshortest_exposure_s = {}\nlongest_exposure_s = {}\n"
      "gain_db = 0.0\nframes_at_most = {}\n"
      "\n[detector.aperture]\ncentre_x_px = {}\ncentre_y_px = {}\nradius_px = {}\n"
      "\n[detector.model]\nelectrons_per_dn = {}\nread_noise_dn = {}\nfull_scale_dn = {}\nexposure_offset_s = {:.10g}\n"
      "u_exposure_offset_s = {:.10g}\nu_linearity = {}\nu_dark_drift_dn_per_s = {:.10g}\n",
      addresses.camera_address, spec.serial, spec.width_px, spec.height_px, spec.pixel_format,
      wall_s(scene, spec.shortest_exposure_s), wall_s(scene, spec.longest_exposure_s), spec.frames_at_most,
      aperture.centre_x_px, aperture.centre_y_px, aperture.radius_px, spec.electrons_per_dn,
      std::sqrt(spec.read_noise_dn * spec.read_noise_dn + kRounding), static_cast<int>(spec.full_scale_dn()),
      wall_s(scene, told.exposure_offset_s), wall_s(scene, told.u_exposure_offset_s),
      told.u_linearity.value_or(spec.u_linearity), told.u_dark_drift_dn_per_s * scene.time_scale);
}

// Far below what any sample of few may show by chance, far above a number that does not move.
std::string least_scatter_line(const LampSpec& lamp, bool is_radiometer) {
  constexpr double kShare = 1e-3;
  if (is_radiometer || lamp.monitor_noise == 0.0) return {};
  return fmt::format("monitor_least_scatter = {:.6g}\n", kShare * lamp.monitor_noise);
}

std::string uncertainty_sections(const Scene& scene) {
  const AngleSpec& angles = scene.angles;
  const LampSpec& lamp = scene.lamp;
  const RadiometerSpec* meter = radiometer_at(scene, RadiometerPlace::Monitor);
  const double monitor = lamp.power * (meter == nullptr ? 1.0 : meter->watts);
  const ToldSpec& told = scene.told;
  return fmt::format(
             "\n[angles]\nu_zero_theta_i_deg = {:.10g}\nu_zero_theta_r_deg = {:.10g}\nu_zero_phi_r_deg = {:.10g}\n"
             "u_repeat_deg = {:.10g}\ndetector_half_cone_deg = {:.10g}\nsource_half_cone_deg = {:.10g}\n"
             "\n[lamp]\nu_after_monitor = {}\ncorrelation_s = {}\nu_reproducibility = {}\nmonitor_low = "
             "{:.6g}\nmonitor_high "
             "= {:.6g}\n",
             in_degrees(told.u_zero_theta_i.value_or(angles.u_zero_theta_i)),
             in_degrees(told.u_zero_theta_r.value_or(angles.u_zero_theta_r)),
             in_degrees(told.u_zero_phi_r.value_or(angles.u_zero_phi_r)),
             in_degrees(told.u_repeat.value_or(angles.u_repeat)), in_degrees(told.detector_half_cone),
             in_degrees(told.source_half_cone), told.u_after_monitor.value_or(lamp.u_after_monitor),
             wall_s(scene, lamp.correlation_s), told.u_reproducibility.value_or(lamp.u_reproducibility), 0.2 * monitor,
             5.0 * monitor) +
         least_scatter_line(lamp, meter != nullptr);
}

// Of an effect that the scene names only; what is fixed has no uncertainty.
std::string beams_section(const Scene& scene) {
  if (!scene.effects.overlap) return {};
  const OverlapSpec& overlap = *scene.effects.overlap;
  std::string text = fmt::format(
      "\n[beams]\nspot_radius_mm = {:.10g}\nu_spot_radius_mm = 0.0\nfield_radius_mm = {:.10g}\nu_field_radius_mm = "
      "0.0\n",
      in_millimetres(overlap.spot_radius), in_millimetres(overlap.field_radius));
  const auto add = [&text](std::string_view key, const std::optional<Length>& radius) {
    if (radius) text += fmt::format("{} = {:.10g}\n", key, in_millimetres(*radius));
  };
  add("sample_radius_mm", overlap.sample_radius);
  add("reference_radius_mm", overlap.reference_radius);
  return text;
}

std::string absolute_section(const Scene& scene) {
  if (!scene.effects.stop) return {};
  const StopSpec& stop = *scene.effects.stop;
  return fmt::format(
      "\n[absolute]\nstop_radius_mm = {:.10g}\nu_stop_radius_mm = {:.10g}\nstop_distance_mm = "
      "{:.10g}\nu_stop_distance_mm = {:.10g}\n",
      in_millimetres(stop.radius.value), in_millimetres(stop.radius.u), in_millimetres(stop.distance.value),
      in_millimetres(stop.distance.u));
}

}  // namespace

std::string instrument_toml(const Scene& scene, const WireAddresses& addresses) {
  return fmt::format(
             "# The instrument of the scene \"{0}\", written by goniosim. All times are wall time.\n"
             "[instrument]\nname = \"simulated: {0}\"\n",
             scene.name) +
         stage_section(scene, addresses) + detector_section(scene, addresses) + radiometer_monitor_section(scene) +
         uncertainty_sections(scene) + beams_section(scene) + absolute_section(scene);
}

}  // namespace gonio::sim
