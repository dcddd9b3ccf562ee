#pragma once

#include <string>
#include <vector>

#include "reflectance/surface/surface_sum.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {

struct NamedSurface {
  std::string name;
  Surface surface;
};

inline Surface sum_of(std::vector<SurfaceTerm> terms) {
  return Surface(SurfaceSum::make(std::move(terms)).value());
}

/// One of each model of make_surface, and a glossy wheat: a mirror above a canopy.
inline std::vector<NamedSurface> sampled_surfaces() {
  const std::vector<std::pair<std::string, Parameters>> models{
      {"lambertian", {{"rho", 0.5}}},
      {"minnaert", {{"rho", 0.5}, {"k", 0.5}}},
      {"hapke", {{"omega0", 0.9}}},
      {"hapke_as_printed", {{"omega0", 0.9}}},
      {"hapke_exact", {{"omega0", 0.9}}},
      {"hapke_hg", {{"omega0", 0.9}, {"g", -0.3}}},
      {"hapke_exact_hg", {{"omega0", 0.9}, {"g", -0.7}}},
      {"rpv", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}}},
      {"rpv_brf", {{"rho0", 0.05}, {"k", 0.6}, {"g", -0.3}}},
      {"fresnel_mirror", {{"refractive_index", 1.34}}},
      {"water_body", {{"rho_w", 0.02}, {"refractive_index", 1.34}}},
      {"cox_munk", {{"wind_m_per_s", 10.0}, {"refractive_index", 1.34}}},
      {"cox_munk_smith", {{"wind_m_per_s", 5.0}, {"refractive_index", 1.34}}},
      {"glint", {{"slope_variance", 0.004}, {"refractive_index", 1.5}}},
      {"glint_smith", {{"slope_variance", 0.01}, {"refractive_index", 1.5}}},
      {"beckmann", {{"roughness", 0.3}, {"refractive_index", 1.5}}},
      {"ggx", {{"roughness", 0.3}, {"refractive_index", 1.5}}},
  };
  std::vector<NamedSurface> all;
  for (const auto& [name, parameters] : models) all.push_back({name, surface(name, parameters)});
  all.push_back(
      {"wheat_and_mirror", sum_of({{wheat(), 0.6}, {surface("fresnel_mirror", {{"refractive_index", 1.5}}), 1.0}})});
  return all;
}

}  // namespace gonio::reflectance
