#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/units.h"
#include "protocol/stage/axis.h"
#include "protocol/stage/drive_stage_map.h"
#include "protocol/stage/register_map.h"
#include "reflectance/surface/surface.h"
#include "sim/faults/fault_plan.h"
#include "sim/scene/effects_spec.h"
#include "sim/scene/radiometer_spec.h"
#include "sim/scene/reference_spec.h"
#include "sim/scene/told_spec.h"
#include "sim/scene/turning_sample_spec.h"

namespace gonio::sim {

/// One slot of the filter wheel.
struct FilterSpec {
  int slot = 1;
  Wavelength centroid;
  Wavelength fwhm;
  double transmission = 1.0;
  double out_of_band_fraction = 0.0;  ///< told to the daemon; the scene's surfaces are grey, so it changes no signal
  /// An attenuator that stands with it: light passed / light, as its certificate says; the truth is a draw from u.
  std::optional<Measured<double>> attenuation{};
};

/// The lamp and its monitor. Relative numbers; an effect of 0 is off. Times are scene time.
struct LampSpec {
  double power = 1.0;           ///< output at the start of the scene, in the monitor's unit
  double drift_per_hour = 0.0;  ///< relative, linear
  double wave = 0.0;            ///< relative amplitude of a slow sinusoid
  double wave_period_s = 900.0;
  double flicker = 0.0;  ///< relative standard deviation of the output's mean over one cell, white between cells
  double flicker_cell_s = 0.01;
  double monitor_noise = 0.0;  ///< relative standard deviation of one sample of the monitor
  double monitor_rate_hz = 10000.0;
  double u_after_monitor = 0.0;  ///< relative sd of the DIFFERENCE of two readings far apart that the monitor misses
  double correlation_s = 3600.0;
  double u_reproducibility = 0.0;  ///< relative, one draw for each move of the stage
};

/// The camera as a detector: photon transfer (EMVA 1288, release 4.0, section 2), linear but for `u_linearity`.
struct DetectorSpec {
  std::string serial = "SIM-0001";
  int width_px = 64;
  int height_px = 64;
  double electrons_per_s = 0.0;  ///< of one lit pixel, before a surface with REFF cos(theta_i) = 1, lamp power 1
  double electrons_per_dn = 4.0;
  double read_noise_dn = 0.0;  ///< before quantisation
  double dark_dn_per_s = 0.0;
  double offset_dn = 0.0;
  double u_linearity = 0.0;          ///< net' = net (1 + eps net / full scale), eps drawn once a seed
  double spot_radius_px = 24.0;      ///< the lit spot, in the middle of the frame
  double aperture_radius_px = 12.0;  ///< told to the daemon
  double shortest_exposure_s = 0.001;
  double longest_exposure_s = 0.512;
  int frames_at_most = 64;
  SpeckleSpec speckle;
  std::string pixel_format = "Mono12";  ///< told to the daemon; the camera also takes the other packings of its bits
  int bits = 12;                        ///< of a pixel: those of the format
  bool has_temperature = true;          ///< a sensor in the camera's housing
  double flat_sigma = 0.0;              ///< of the pixels' response to even light, relative
  double bad_fraction = 0.0;            ///< of the pixels; see PixelPattern
  [[nodiscard]] double full_scale_dn() const { return static_cast<double>((1U << static_cast<unsigned>(bits)) - 1U); }
  double control_heartbeat_wall_s = 3.0;  ///< a silent controller of the camera is released after so long; wall time
};

/// One axis; its own unit, scene time.
struct AxisSpec {
  double low = 0.0;
  double high = 0.0;
  double speed = 1.0;
  double acceleration = 1.0;
  double settle_s = 0.0;
  double window = 0.0;
  double backlash = 0.0;  ///< the play between the motor, which has the encoder, and what it moves
};

/// The stage; scene time but where the name says wall.
struct StageSpec {
  stage::PerAxis<AxisSpec> axes{};
  double sample_mm = 0.0;
  double reference_mm = 120.0;
  double trap_mm = 240.0;
  std::optional<double> open_mm{};  ///< a place of the carriage where nothing stands in the beam
  double shutter_s = 0.0;           ///< travel; light passes when it is fully open
  double following_error_s = 0.5;   ///< a blocked axis is noticed after so long
  double heartbeat_timeout_wall_s = 2.0;
  stage::RegisterMap registers;                     ///< our own
  std::optional<stage::DriveStageMap> drives;       ///< when set, the stage is one of drives; scales in wall time
  std::optional<TurningSampleSpec> turning_sample;  ///< else each axis is the angle of its name
};

/// Standard uncertainties (k = 1) of the directions: what the daemon is told, and what the truth is drawn from.
struct AngleSpec {
  Angle u_zero_theta_i;
  Angle u_zero_theta_r;
  Angle u_zero_phi_r;
  Angle u_repeat;
};

struct EnvironmentSpec {
  Temperature lamp = celsius(45.0);
  Temperature detector = celsius(25.0);
  Temperature room = celsius(22.0);
  double humidity_percent = 40.0;
};

/// What stands on the simulated bench: everything there is to know but the chance of one seed (`Truth`).
struct Scene {
  std::string name;
  std::uint64_t seed = 1;
  double time_scale = 1.0;                       ///< scene seconds in one wall second
  bool draws_errors = true;                      ///< false: certificate, shape, zeros, linearity are exactly as stated
  std::vector<reflectance::SurfaceTerm> sample;  ///< the sum of weight x surface
  ReferenceSpec reference;
  LampSpec lamp;
  DetectorSpec detector;
  StageSpec stage;
  AngleSpec angles;
  EnvironmentSpec environment;
  std::vector<FilterSpec> filters;
  std::vector<RadiometerSpec> radiometers;  ///< one before the sample and one before the lamp at most
  EffectsSpec effects;
  ToldSpec told;
  FaultPlan faults;

  [[nodiscard]] double scene_seconds(Duration wall) const { return in_seconds(wall) * time_scale; }
  [[nodiscard]] Duration wall(double scene_s) const { return seconds(scene_s / time_scale); }
};

}  // namespace gonio::sim
