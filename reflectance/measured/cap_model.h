#pragma once

#include <vector>

#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// A surface that stands where nothing was measured, with all that is known of its uncertainty. Fits make it
/// (reflectance/fit); whoever knows a surface exactly gives it without parameters.
struct CapModel {
  /// How the surface moves with one fitted number, and that number with the readings.
  struct Parameter {
    Surface shifted;                  ///< the surface with the number `shift` greater
    double shift = 0.0;               ///< not 0
    std::vector<double> per_reading;  ///< d number / d value of each point of the scan [per sr^-1]; as many as points
  };
  /// Another model of the same readings, and how likely it is beside the surface itself (Akaike weights, which sum
  /// to 1 with that of the surface).
  struct Rival {
    Surface surface;
    double weight = 0.0;
  };

  Surface surface;
  std::vector<Parameter> parameters;
  std::vector<Rival> rivals;
  /// How far the readings lie from the surface beyond their noise, relative to them, k = 1: of a surface that is not
  /// quite theirs no more is known where nothing was measured. One sign over all that is modelled.
  double u_lack_of_fit = 0.0;
};

}  // namespace gonio::reflectance
