#pragma once

#include <optional>
#include <vector>

#include "base/units.h"

namespace gonio::calibration {

/// A measured profile across a round beam: the value at a radius, in units of the beam's radius.
struct RadialNode {
  double of_radius = 0.0;
  double value = 0.0;  ///< on any scale, >= 0
};

/// Round lit spot and round field of view across their beams, and the round targets they fall on. Uncertainties k = 1.
struct OverlapModel {
  Measured<Length> spot_radius;
  Measured<Length> field_radius;
  std::optional<Length> sample_radius;     ///< none: endless
  std::optional<Length> reference_radius;  ///< none: endless
  Length u_target_radius;                  ///< of both
  /// Of the amplitude c of a beam that is brighter (more sensitive) in its middle, 1 + c (1 - 2 rho^2 / radius^2),
  /// which leaves what it carries in all.
  double u_spot_falloff = 0.0;
  double u_field_falloff = 0.0;
  Length u_offset;  ///< of the spot's axis from the field's, across the spot's beam, in each of two directions
  /// Ascending, linear between, the first one's value inside of it, 0 beyond the last. Empty: evenly filled. The radius
  /// scales them.
  std::vector<RadialNode> spot_profile;
  std::vector<RadialNode> field_profile;
};

}  // namespace gonio::calibration
