#pragma once

#include <functional>
#include <limits>
#include <optional>

#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// Any function of the direction as a sky, smooth but for one point. Its values are checked as they are met: one that
/// is negative or not finite (or no function at all) ends the integral with an error that names the direction. An edge,
/// or a ripple finer than some 5 deg, is not resolved, and the error that comes with the integral may then be too
/// small: build a patchy sky of a table, a disk of a SunDisk. Called from the caller's thread only.
struct FormulaSky {
  std::function<double(const Direction&)> formula;     ///< L_i [W m^-2 sr^-1 or relative]
  bool depends_on_theta_only = false;                  ///< a promise, which makes integrals cheaper
  std::optional<Direction> pointed_at = std::nullopt;  ///< where it has a kink or a bright point, as an aureole has

  [[nodiscard]] double radiance(const Direction& i) const {
    return formula ? formula(i) : std::numeric_limits<double>::quiet_NaN();
  }
  [[nodiscard]] bool is_zonal() const { return depends_on_theta_only; }
  [[nodiscard]] std::optional<Direction> peak() const { return pointed_at; }
};

}  // namespace gonio::reflectance
