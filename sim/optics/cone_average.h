#pragma once

#include <functional>

#include "base/geometry.h"
#include "reflectance/direction/direction.h"
#include "sim/scene/effects_spec.h"

namespace gonio::sim {

/// What a finite source and a finite detector make of a BRDF.
struct ConeAverage {
  Brdf brdf;            ///< the mean of f over both cones, weighted with mu_i mu_r dOmega_i dOmega_r
  double mu_i = 0.0;    ///< the mean of mu_i over the source's cone: the irradiance's cosine
  double error = 0.0;   ///< relative; the difference of the last two orders
  int evaluations = 0;  ///< of f, in all orders
};

using BrdfOfDirections = std::function<Brdf(const reflectance::Direction&, const reflectance::Direction&)>;

/// The average about the geometry's two directions (thetas below 90 deg). Each cone is a spherical cap of directions
/// with even radiance, integrated with Peirce's rule for the disc (1957): k Gauss-Legendre rings in 1 - cos(gamma),
/// 4 k directions on each, the rings of one cone times those of the other. k = 2, 3, 4, 6, 8, until two orders
/// differ by less than the tolerance; at the last order it ends, and `error` says how well. Directions below the
/// horizon give and get no light. A cone of 0 is one direction: with both, f is called once.
[[nodiscard]] ConeAverage average_over_cones(const ConeSpec& cones, const Geometry& centre, const BrdfOfDirections& f);

}  // namespace gonio::sim
