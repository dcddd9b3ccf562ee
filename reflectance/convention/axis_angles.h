#pragma once

#include <string_view>

#include "base/result.h"
#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// Half of phi_i - phi_r by sine and cosine, cosine at least 0. A difference that a mirrored azimuth's rounding leaves
/// of a half turn (2 ulp of 180 deg) is a half turn: the cosine is 0 then, so that mirror directions are met exactly.
struct HalfAzimuth {
  double angle;  ///< [rad]
  double sine;
  double cosine;
};
[[nodiscard]] HalfAzimuth half_azimuth(const Direction& i, const Direction& r);

/// phi_r - phi_i in (-180, 180] deg as the pole wants it: 0 for r in the pole; from phi = 0 for i in the pole.
[[nodiscard]] Angle relative_azimuth(const Direction& i, const Direction& r);

/// An azimuth about an axis by what the formulas take of it: no form cancels, and the opposite azimuth is a swap.
struct AxisTurn {
  double cos2_half;
  double sin2_half;
  double sine;
  [[nodiscard]] static AxisTurn of(Angle azimuth);
  [[nodiscard]] AxisTurn opposite() const { return {sin2_half, cos2_half, -sine}; }
};

/// The direction at `arc` [rad, 0 to pi] from `axis` in azimuth `turn` about it: 0 towards the normal,
/// counter-clockwise seen from outside. To some 1e-16 rad. Errors: InvalidInput when it lies below the horizon by more
/// than rounding (1e-15); `what` says which direction that is.
[[nodiscard]] Result<Direction> direction_about(const Direction& axis, double arc, const AxisTurn& turn,
                                                std::string_view what);

/// InvalidInput unless least <= angle <= most, NaN included. `what` is the convention, `name` the angle.
[[nodiscard]] Result<void> check_angle(std::string_view what, std::string_view name, Angle angle, Angle least,
                                       Angle most);
/// InvalidInput unless the angle is finite.
[[nodiscard]] Result<void> check_azimuth(std::string_view what, std::string_view name, Angle angle);

}  // namespace gonio::reflectance
