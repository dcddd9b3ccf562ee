#pragma once

#include <span>
#include <vector>

#include "reflectance/direction/direction.h"
#include "reflectance/surface/surface.h"
#include "sim/optics/space.h"
#include "sim/scene/effects_spec.h"

namespace gonio::sim {

/// The electric vectors that the two arms prefer: of unit length, across their axes.
struct PolarisationAxes {
  Vector source;
  Vector detector;
};
/// Of arms in these directions: the plane's angle from the horizontal direction of growing phi, towards the normal.
[[nodiscard]] PolarisationAxes polarisation_axes(const PolarisationSpec& spec, const Geometry& g);

/// A sample in partly polarised light before a detector that prefers one plane. Two kinds of terms only:
///   facets (glint, Cox and Munk)  Fresnel's amplitudes of a clear dielectric in the plane of the two directions
///                                 (Born and Wolf 1999, 1.5.2), each facet a mirror without memory of the others
///   all other terms               depolarise: what comes in counts as a whole, what goes out is unpolarised
/// So no light is circular, no diffuse term keeps a part of its polarisation, and a water body is as diffuse as sand.
/// Unpolarised light before any detector, or any light before an indifferent detector on a diffuse term, gives f.
/// Immutable; threads: any.
class PolarisedSample {
 public:
  PolarisedSample(const PolarisationSpec& spec, std::span<const reflectance::SurfaceTerm> terms);

  /// The f that the detector takes the sample to have. Directions off the centre of a cone carry the centre's planes
  /// along, projected across themselves.
  [[nodiscard]] Brdf seen(const reflectance::Direction& i, const reflectance::Direction& r,
                          const PolarisationAxes& axes) const;

 private:
  struct Term {
    reflectance::SurfaceTerm term;
    double refractive_index = 0.0;  ///< 0: depolarises
  };
  /// What a facet with both directions on its mirror gives, over what it gives without polarisation.
  [[nodiscard]] double facet_factor(double n, const Vector& i, const Vector& r, const PolarisationAxes& axes) const;

  PolarisationSpec spec_;
  std::vector<Term> terms_;
};

}  // namespace gonio::sim
