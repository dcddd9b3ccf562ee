#pragma once

#include <string>
#include <vector>

#include "reflectance/surface/surface.h"

namespace gonio::bench {

/// A surface lit from one direction, with the directional-hemispherical reflectance that it truly has.
struct Case {
  std::string surface_name;
  reflectance::Surface surface;
  double theta_i_deg = 0.0;
  double rho_dh = 0.0;  ///< to 1e-13 or better, from outside of the library: see cases.cpp

  [[nodiscard]] reflectance::Direction incidence() const {
    return reflectance::Direction::from_angles(degrees(theta_i_deg), Angle{});
  }
};

/// The cases of the comparison, surface by surface.
[[nodiscard]] std::vector<Case> rho_dh_cases();

/// A model's surface whose parameters are right: a wrong one ends the program with the model's own message.
[[nodiscard]] reflectance::Surface surface_of(std::string_view model, const reflectance::Parameters& parameters);

/// f of another surface and nothing else of it but its feature: no closed form is left.
[[nodiscard]] reflectance::Surface with_formula_hidden(const reflectance::Surface& surface);

}  // namespace gonio::bench
