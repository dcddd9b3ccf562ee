#pragma once

#include <string_view>
#include <vector>

#include "reflectance/surface/make_surface.h"

namespace gonio::reflectance {

/// A surface whose parameters a test has right.
inline Surface surface(std::string_view model, const Parameters& parameters) {
  return make_surface(model, parameters).value();
}

/// The wheat canopy of Mobley (2005), eq 8 as printed.
inline Surface wheat() {
  return surface("rpv", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}});
}

/// A sea under 10 m/s of wind: slope variance 0.0542.
inline Surface sea(std::string_view model = "cox_munk") {
  return surface(model, {{"wind_m_per_s", 10.0}, {"refractive_index", 1.34}});
}

/// phi_i = 0, all in degrees.
inline Geometry geometry(double theta_i, double theta_r, double phi_r) {
  return {.theta_i = degrees(theta_i), .phi_i = {}, .theta_r = degrees(theta_r), .phi_r = degrees(phi_r)};
}

}  // namespace gonio::reflectance
