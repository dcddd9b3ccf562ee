#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "reflectance/light/cie_sky.h"
#include "reflectance/light/formula_sky.h"
#include "reflectance/light/light.h"
#include "reflectance/light/overcast_sky.h"
#include "reflectance/light/table_sky.h"
#include "reflectance/light/uniform_sky.h"

namespace gonio::reflectance {

/// A sun of irradiance 1 across its beam.
inline SunDisk sun(double theta_deg, double phi_deg, double radius_deg = 0.2665) {
  const SunPlace place{.theta = degrees(theta_deg), .phi = degrees(phi_deg), .radius = degrees(radius_deg)};
  return SunDisk::make_from_normal_irradiance(place, 1.0).value();
}

/// A patchy sky: rows every 15 deg of theta, columns every 40 deg of phi; as in light_reference_values.py.
inline TableSky patchy_sky() {
  std::vector<Angle> thetas;
  std::vector<Angle> phis;
  std::vector<double> radiances;
  for (int j = 0; j <= 6; ++j) thetas.push_back(degrees(15.0 * j));
  for (int k = 0; k < 9; ++k) phis.push_back(degrees(40.0 * k));
  for (int j = 0; j <= 6; ++j) {
    for (int k = 0; k < 9; ++k) radiances.push_back(1.0 + 0.25 * ((7 * j + 3 * k) % 5));
  }
  return TableSky::make(thetas, phis, radiances).value();
}

/// Brighter towards phi = 70 deg: 1 + cos(phi - 70 deg) sin(theta) / 2.
inline FormulaSky lopsided_sky() {
  return {.formula = [](const Direction& i) {
    return 1.0 + 0.5 * i.sin_theta() * std::cos((i.phi() - degrees(70.0)).si());
  }};
}

struct NamedLight {
  std::string name;
  Light light;
};

/// One of each kind, and a sum.
inline std::vector<NamedLight> lights() {
  const Direction high = Direction::from_angles(degrees(50.0), degrees(20.0));
  const CieSky clear = CieSky::make(12, high, 1.0).value();
  return {{"uniform", UniformSky::make(1.0).value()},
          {"overcast", OvercastSky::make(1.0).value()},
          {"beam", Beam::make(high, 1.0).value()},
          {"sun", sun(50.0, 20.0)},
          {"sun at the zenith", sun(0.0, 0.0)},
          {"sun partly set", sun(90.1, 20.0)},
          {"clear", clear},
          {"patchy", patchy_sky()},
          {"lopsided", lopsided_sky()},
          {"sun and clear sky", sun(50.0, 20.0) + 0.1 * clear}};
}

}  // namespace gonio::reflectance
