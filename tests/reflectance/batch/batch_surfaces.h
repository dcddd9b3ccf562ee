#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "reflectance/surface/surface_sum.h"
#include "tests/reflectance/generated.h"
#include "tests/reflectance/surfaces.h"

namespace gonio::reflectance {

/// Every model in the middle and at both ends of its parameters' ranges, and sums.
inline std::vector<Surface> batch_surfaces() {
  std::vector<Surface> surfaces;
  for (const ModelSpec& spec : surface_models()) {
    for (const double where : {0.0, 0.37, 0.9, 1.0}) {
      Parameters parameters;
      for (const ParameterSpec& p : spec.parameters) {
        const double value = p.least + where * (std::min(p.most, 10.0) - p.least);
        parameters.push_back({std::string(p.name), where == 1.0 ? p.most : value});
      }
      surfaces.push_back(surface(spec.name, parameters));
    }
  }
  surfaces.push_back(wheat());
  surfaces.push_back(sea());
  surfaces.push_back(sea("cox_munk_smith"));
  surfaces.push_back(surface("glint", {{"slope_variance", 1e-4}, {"refractive_index", 1.34}}));
  surfaces.emplace_back(SurfaceSum::make({{wheat(), 0.3}, {sea(), 0.7}, {sea("cox_munk_smith"), 1.1}}).value());
  return surfaces;
}

/// 64 views: half of them generated, the others close to retro-reflection and to the mirror direction of `i`, or in the
/// same or the opposite azimuth along the horizon.
inline std::vector<Direction> hard_views(const Direction& i, GeneratedDirections& directions) {
  constexpr double kQuarter = 1.5707963267948966;
  std::vector<Direction> views;
  while (views.size() < 64) {
    const double distance = std::pow(10.0, -14.0 * directions.unit());
    const double theta = std::clamp(i.theta().si() + distance * (directions.unit() - 0.5), 0.0, kQuarter);
    const double turn = distance * (directions.unit() - 0.5);
    views.push_back(directions.next());
    views.push_back(Direction::from_angles(radians(theta), radians(i.phi().si() + turn)));
    views.push_back(mirrored(views.back()));
    views.push_back(Direction::from_elevation(radians(std::min(kQuarter, distance)), radians(i.phi().si() + turn)));
  }
  return views;
}

struct FastError {
  double bound_share = 0.0;  ///< the largest |fast - exact| / (relative_error exact + absolute_error)
  bool is_valid = true;      ///< all numbers finite
};

/// Of `pairs` pairs, drawn from `seed`.
inline FastError worst_fast_error(const Surface& s, int pairs, std::uint64_t seed) {
  GeneratedDirections directions(seed);
  const FastPath path = s.fast_path();
  FastError worst;
  for (int done = 0; done < pairs; done += 64) {
    const Direction i = directions.next();
    const std::vector<Direction> views = hard_views(i, directions);
    std::vector<Brdf> exact(views.size());
    std::vector<Brdf> fast(views.size());
    s.eval(i, views, exact);
    s.eval_fast(i, views, fast);
    for (std::size_t k = 0; k < views.size(); ++k) {
      const double difference = std::abs(fast[k].si() - exact[k].si());
      if (difference == 0.0) continue;
      const double bound = path.relative_error * exact[k].si() + path.absolute_error.si();
      worst.is_valid = worst.is_valid && std::isfinite(fast[k].si());
      worst.bound_share = std::max(worst.bound_share, difference / bound);
    }
  }
  return worst;
}

}  // namespace gonio::reflectance
