#pragma once

#include "base/geometry.h"
#include "base/units.h"
#include "sim/scene/effects_spec.h"

namespace gonio::sim {

/// The round stop before the detector, facing the arms' centre.
struct Stop {
  Length radius;
  Length distance;
};

/// What the stop takes of the light that an evenly lit, even diffuser sends back, as a solid angle: the mean over the
/// lit spot, a disc of `spot_radius` across the source's beam, of
///   int cos(t) cos(b) / (mu_r r^2) dA,
/// t from the surface's normal, b from the stop's, r from the point of the spot to that of the stop. Both discs by
/// three rings of eight points each: beyond 1e-6 where both sizes are below a tenth of the distance. A point at the
/// centre sees pi sin^2 of the stop's half angle.
[[nodiscard]] SolidAngle stop_solid_angle(const Stop& stop, Length spot_radius, const Geometry& g);

/// Straight through: what a parallel beam as wide as the lit spot brings through the stop, in units of what white
/// brings at REFF cos(theta_i) = 1 with the field of view inside the spot. All of the beam within the stop brings
/// (a_spot / a_field)^2 pi / Omega, Omega the solid angle of a point at the centre; beside it what both discs have in
/// common. 0 where the detector does not look towards the source.
[[nodiscard]] double direct_light(const Stop& stop, const OverlapSpec& beams, const Geometry& g);

}  // namespace gonio::sim
