#pragma once

#include "base/geometry.h"
#include "sim/scene/effects_spec.h"

namespace gonio::sim {

/// A point of the surface, in its own plane: x along phi = 0, y along phi = 90 deg.
struct SurfacePoint {
  Length x;
  Length y;
};

/// What a leaning, raised surface makes of the arms' directions.
struct MountedView {
  Geometry geometry;  ///< in the frame of the surface, from the middle of the field of view; thetas may pass 90 deg
  double source_near = 1.0;    ///< nominal distance of the source over the true one
  double detector_near = 1.0;  ///< of the detector likewise
  SurfacePoint spot;           ///< middle of the lit spot, seen from the middle of the target
  SurfacePoint field;          ///< of the field of view likewise
};

/// The view of a target on this mount, for the arms' directions `g` (thetas in [0, 90 deg)). The normal is (sin l cos
/// a, sin l sin a, cos l) with l cos a = lean_0 and l sin a = lean_90; phi is carried along without a twist (Rodrigues
/// 1840). Both arms aim at their common centre; the surface is met where the detector's axis pierces it, and the light
/// comes to that point from the source's place: exact for any lean and height.
[[nodiscard]] MountedView view_on(const MountSpec& mount, Length source_distance, Length detector_distance,
                                  const Geometry& g);

}  // namespace gonio::sim
