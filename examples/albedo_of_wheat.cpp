// The albedo of a wheat field under a sun at 60 deg and an overcast sky: value, error, cost.
#include <cstdio>

#include "reflectance/light/lit_reflectance.h"
#include "reflectance/light/overcast_sky.h"
#include "reflectance/surface/rpv.h"

using namespace gonio::reflectance;
using namespace gonio::literals;

int main() {
  const auto wheat = Rpv::make({.rho0 = 0.133, .k = 0.851, .g = -0.114});
  const auto sun = SunDisk::make_from_normal_irradiance({.theta = 60.0_deg, .phi = 135.0_deg}, 1000.0);  // W m^-2
  const auto sky = OvercastSky::make(50.0);                                                              // W m^-2 sr^-1
  if (!wheat || !sun || !sky) return 1;

  const auto albedo = hemispherical_reflectance(*wheat, *sun + *sky, 1e-6);
  if (!albedo) return std::fprintf(stderr, "%s\n", describe(albedo.error()).c_str()), 1;

  std::printf("albedo %.9f +- %.1e after %llu evaluations\n", albedo->value, albedo->error,
              static_cast<unsigned long long>(albedo->evaluations));
  return albedo->is_physical() ? 0 : 2;
}
