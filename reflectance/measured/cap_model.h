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
  /// Of a surface that is not that of the readings: how far they lie from it, relative to it, k = 1. 0 where it holds.
  /// An integral looks for itself at what lies next to its unmeasured part (cap_rim.h), and takes this where there is
  /// nothing.
  double u_lack_of_fit = 0.0;
};

}  // namespace gonio::reflectance
