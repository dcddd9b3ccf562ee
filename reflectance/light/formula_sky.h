#pragma once

#include <functional>
#include <optional>

#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// Any function of the direction as a sky. Its values are checked as they are met: one that is negative or not finite
/// ends the integral with an error that names the direction. Called from the caller's thread only.
struct FormulaSky {
  std::function<double(const Direction&)> formula;     ///< L_i [W m^-2 sr^-1 or relative]
  bool depends_on_theta_only = false;                  ///< a promise, which makes integrals cheaper
  std::optional<Direction> pointed_at = std::nullopt;  ///< where it has a kink or a bright point, as an aureole has

  [[nodiscard]] double radiance(const Direction& i) const { return formula(i); }
  [[nodiscard]] bool is_zonal() const { return depends_on_theta_only; }
  [[nodiscard]] std::optional<Direction> peak() const { return pointed_at; }
};

}  // namespace gonio::reflectance
