#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "reflectance/direction/direction_pair.h"
#include "reflectance/surface/surface_sum.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {

/// Surfaces of every model with drawn parameters, the same for a seed: each parameter is at an end of its range, evenly
/// between, or within 1 to 1e-12 of an end.
class GeneratedSurfaces {
 public:
  explicit GeneratedSurfaces(std::uint64_t seed) : engine_(seed) {}

  double unit() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }

  Surface next(const ModelSpec& spec) {
    Parameters parameters;
    for (const ParameterSpec& p : spec.parameters) parameters.push_back({std::string(p.name), number_in(p)});
    return surface(spec.name, parameters);
  }

  std::vector<Surface> of_every_model(int draws) {
    std::vector<Surface> all;
    for (const ModelSpec& spec : surface_models()) {
      for (int k = 0; k < draws; ++k) all.push_back(next(spec));
    }
    for (int k = 0; k < draws; ++k) {
      all.emplace_back(SurfaceSum::make({{any(), unit()}, {any(), 2.0 * unit()}, {any(), 0.0}}).value());
    }
    return all;
  }

 private:
  Surface any() {
    const auto models = surface_models();
    return next(models[engine_() % models.size()]);
  }

  double number_in(const ParameterSpec& p) {
    const double width = p.most - p.least;
    const double step = width * std::pow(10.0, -12.0 * unit());
    switch (engine_() % 8) {
      case 0:
        return p.least;
      case 1:
        return p.most;
      case 2:
        return std::min(p.most, p.least + step);
      case 3:
        return std::max(p.least, p.most - step);
      default:
        return std::clamp(p.least + width * unit(), p.least, p.most);
    }
  }

  std::mt19937_64 engine_;
};

/// "rpv rho0 0.133 k 0.851 g -0.114", to make it again by.
inline std::string text_of(const Surface& s) {
  std::string text(s.model());
  for (const NamedNumber& p : s.parameters()) text += fmt::format(" {} {}", p.name, p.value);
  return text;
}

/// Both directions in radians, with all their digits.
inline std::string text_of(const Direction& i, const Direction& r) {
  return fmt::format("i {} {}, r {} {} rad", i.theta().si(), i.phi().si(), r.theta().si(), r.phi().si());
}

}  // namespace gonio::reflectance
