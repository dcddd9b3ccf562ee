#pragma once

#include <optional>

#include "base/units.h"
#include "protocol/stage/axis.h"

namespace gonio::sim {

/// The light comes from, and is seen in, a cone of directions about the arm: both spherical caps, evenly filled.
struct ConeSpec {
  Angle source_half;
  Angle detector_half;
  double tolerance = 1e-5;  ///< relative, of the averaged BRDF
};

/// Round lit spot and round field of view, as they are across their beams, on a round piece of surface.
struct OverlapSpec {
  Length spot_radius;
  Length field_radius;
  std::optional<Length> sample_radius;     ///< none: endless
  std::optional<Length> reference_radius;  ///< none: endless
};

/// The round stop that bounds what the detector takes in: straight through, with nothing in the way, all of the beam
/// passes it. As its certificate says; the truth is a draw from both u (k = 1).
struct StopSpec {
  Measured<Length> radius;
  Measured<Length> distance;  ///< from the arms' centre
};

/// How one target stands on its carriage: the normal leans by `lean_0` towards phi = 0 and by `lean_90` towards phi =
/// 90 deg, the surface lies `height` above the arms' centre.
struct MountSpec {
  Angle lean_0;
  Angle lean_90;
  Length height;
};

struct MountingSpec {
  MountSpec sample;
  MountSpec reference;
  Length source_distance = millimetres(600.0);
  Length detector_distance = millimetres(500.0);
};

/// What an eccentric circle adds: true angle = encoder + amplitude sin(360 deg encoder / period + phase).
struct PeriodicError {
  Angle amplitude;
  Angle period = degrees(360.0);
  Angle phase;
};

/// Planes are angles from the horizontal (s) direction of the arm, towards the plane of the normal (90 deg: p).
struct PolarisationSpec {
  double source_degree = 0.0;  ///< linear, of the lamp's light
  Angle source_plane;
  double detector_diattenuation = 0.0;  ///< (most - least) / (most + least) of its answers to linear light
  Angle detector_plane;
};

/// Light that takes other ways than lamp, sample, detector. It falls evenly on all pixels.
struct StraySpec {
  double ambient_electrons_per_s = 0.0;  ///< room light: whatever the lamp and the source shutter do
  double source_share = 0.0;             ///< of white at normal incidence: from the source past any target
  double internal_share = 0.0;           ///< of all the light that leaves the target, scattered within the detector
};

/// The detector's answer beside the drawn one of `u_linearity`: x' = x (1 + quadratic x + cubic x^2) of full scale,
/// then a soft approach to `saturation` from `knee` on.
struct ResponseSpec {
  double quadratic = 0.0;
  double cubic = 0.0;
  std::optional<double> knee;  ///< of full scale; none: straight on
  double saturation = 1.0;     ///< of full scale; above the knee
};

/// How dark and offset change. Relative to the scene's dark rate where no unit is named; scene time.
struct DarkDriftSpec {
  double per_hour = 0.0;
  double wander = 0.0;  ///< standard deviation of a slow wander of the rate
  double offset_dn_per_hour = 0.0;
  double offset_wander_dn = 0.0;
  double correlation_s = 1800.0;  ///< of both wanders
  double temperature_swing_k = 0.0;
  double temperature_period_s = 3600.0;
  double doubling_k = 8.0;  ///< the rate doubles with so many kelvin
};

/// A grainy brightness of the lit pixels that belongs to the place and stays over exposures.
struct SpeckleSpec {
  double contrast = 0.0;      ///< standard deviation over mean
  int grain_px = 2;           ///< side of a grain
  Angle cell = degrees(0.1);  ///< directions nearer than this have the same pattern
};

/// The effects of a scene that are named in it, each by a table of its own. What is not named is not there.
struct EffectsSpec {
  std::optional<ConeSpec> cones;
  std::optional<OverlapSpec> overlap;
  std::optional<StopSpec> stop;  ///< only beside an overlap, which says how wide the beam is
  std::optional<MountingSpec> mounting;
  stage::PerAxis<std::optional<PeriodicError>> encoder{};  ///< of the four angles only
  std::optional<PolarisationSpec> polarisation;
  std::optional<StraySpec> stray;
  std::optional<ResponseSpec> response;
  std::optional<DarkDriftSpec> dark_drift;
  double exposure_offset_s = 0.0;  ///< t0: light falls for exposure + t0
};

}  // namespace gonio::sim
