#include "reflectance/measured/guide.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "reflectance/surface/make_surface.h"
#include "reflectance/surface/surface_sum.h"

namespace gonio::reflectance {
namespace {

struct WeightedReading {
  Direction i;
  Direction r;
  double f;
  double weight;  ///< 1 by the square of the value, down to a fiftieth of the root mean square
};

std::vector<WeightedReading> weighted_readings(const MeasuredScan& scan) {
  // A shape is told by a few thousand readings as well as by a million.
  constexpr std::size_t kEnough = 4000;
  const std::vector<std::size_t> usable = usable_points(scan);
  const std::size_t step = usable.size() / kEnough + 1;
  double squares = 0.0;
  for (const std::size_t k : usable) squares += scan.points[k].value.si() * scan.points[k].value.si();
  const double least = std::max(1e-300, 0.02 * std::sqrt(squares / static_cast<double>(usable.size())));
  std::vector<WeightedReading> readings;
  for (std::size_t n = 0; n < usable.size(); n += step) {
    const MeasuredPoint& p = scan.points[usable[n]];
    const double size = std::max(least, std::abs(p.value.si()));
    readings.push_back({.i = incident_direction(p.geometry),
                        .r = reflected_direction(p.geometry),
                        .f = p.value.si(),
                        .weight = 1.0 / (size * size)});
  }
  return readings;
}

// The best amplitudes, none below 0, of one or two shapes, and what they leave.
struct Amplitudes {
  double a = 0.0;
  double b = 0.0;
  double left = std::numeric_limits<double>::infinity();
};

struct Sums {
  double aa = 0.0, ab = 0.0, bb = 0.0, af = 0.0, bf = 0.0, ff = 0.0;
  [[nodiscard]] double left(double a, double b) const {
    return ff - 2.0 * (a * af + b * bf) + a * a * aa + 2.0 * a * b * ab + b * b * bb;
  }
};

Amplitudes amplitudes(const Sums& s) {
  std::vector<std::pair<double, double>> trials;
  if (s.aa > 0.0) trials.emplace_back(std::max(0.0, s.af / s.aa), 0.0);
  if (s.bb > 0.0) trials.emplace_back(0.0, std::max(0.0, s.bf / s.bb));
  const double det = s.aa * s.bb - s.ab * s.ab;
  if (det > 1e-12 * s.aa * s.bb) {
    const double a = (s.af * s.bb - s.bf * s.ab) / det;
    const double b = (s.bf * s.aa - s.af * s.ab) / det;
    if (a >= 0.0 && b >= 0.0) trials.emplace_back(a, b);
  }
  Amplitudes best;
  for (const auto& [a, b] : trials) {
    const double left = s.left(a, b);
    if (left < best.left) best = {.a = a, .b = b, .left = left};
  }
  return best;
}

Surface surface_named(std::string_view model, const Parameters& parameters) {
  return make_surface(model, parameters).value();  // of ladders within the models' ranges
}

Amplitudes fitted(std::span<const WeightedReading> readings, const Surface& shape, const Surface* ground) {
  Sums s;
  for (const WeightedReading& p : readings) {
    const double a = shape.eval(p.i, p.r).si();
    const double b = ground != nullptr ? ground->eval(p.i, p.r).si() : 0.0;
    s.aa += p.weight * a * a;
    s.ab += p.weight * a * b;
    s.bb += p.weight * b * b;
    s.af += p.weight * a * p.f;
    s.bf += p.weight * b * p.f;
    s.ff += p.weight * p.f * p.f;
  }
  return amplitudes(s);
}

std::optional<Guide> matte_guide(std::span<const WeightedReading> readings) {
  std::optional<Guide> best;
  double least = std::numeric_limits<double>::infinity();
  for (int step_k = 0; step_k <= 10; ++step_k) {
    for (const double g : {-0.5, -0.3, -0.15, 0.0, 0.15, 0.3}) {
      const Surface shape = surface_named("rpv", {{"rho0", 0.3}, {"k", 0.5 + 0.1 * step_k}, {"g", g}});
      const Amplitudes found = fitted(readings, shape, nullptr);
      if (found.left >= least || found.a <= 0.0) continue;
      least = found.left;
      best = Guide{.name = "matte", .surface = shape};
    }
  }
  return best;
}

std::optional<Guide> lobe_guide(std::span<const WeightedReading> readings) {
  const Surface ground = surface_named("lambertian", {{"rho", 1.0}});
  std::optional<Guide> best;
  double least = std::numeric_limits<double>::infinity();
  for (int step = 0; step < 18; ++step) {
    const double roughness = 0.01 * std::pow(1.3, step);
    for (const char* model : {"ggx", "beckmann"}) {
      const Surface lobe = surface_named(model, {{"roughness", roughness}, {"refractive_index", 1.5}});
      const Amplitudes found = fitted(readings, lobe, &ground);
      if (found.left >= least || found.a <= 0.0) continue;
      least = found.left;
      std::vector<SurfaceTerm> terms{{lobe, found.a}};
      if (found.b > 0.0) terms.push_back({ground, found.b});
      best = Guide{.name = "lobe", .surface = SurfaceSum::make(std::move(terms)).value()};
    }
  }
  return best;
}

}  // namespace

std::vector<Guide> candidate_guides(const MeasuredScan& scan) {
  const std::vector<WeightedReading> readings = weighted_readings(scan);
  std::vector<Guide> guides{{.name = "flat", .surface = surface_named("lambertian", {{"rho", 1.0}})}};
  if (auto matte = matte_guide(readings)) guides.push_back(*std::move(matte));
  if (auto lobe = lobe_guide(readings)) guides.push_back(*std::move(lobe));
  return guides;
}

}  // namespace gonio::reflectance
