#pragma once

namespace gonio::calibration {

/// Corrections that a calibration leaves undone, its budget unchanged: to show what each is worth. A result that left
/// one out names it in its inputs.
struct LeftOut {
  bool dark = false;             ///< dark levels are 0
  bool ambient = false;          ///< visits with the source's shutter closed
  bool stray = false;            ///< visits of the trap, and stated shares
  bool linearity = false;        ///< LinearityModel::coefficients
  bool exposure_offset = false;  ///< t0
  bool monitor = false;          ///< the lamp counts as constant
  bool shape = false;            ///< the standard is taken for Lambertian
  bool cones = false;
  bool mounting = false;
  bool overlap = false;  ///< the factor of the geometry, where it does not cancel
  friend bool operator==(const LeftOut&, const LeftOut&) = default;
};

}  // namespace gonio::calibration
