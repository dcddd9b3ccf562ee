#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>

#include "bench/reflectance/quadrature.h"
#include "bench/reflectance/stopwatch.h"
#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/integral/hemisphere_integral.h"
#include "reflectance/integral/polar_integral.h"
#include "reflectance/integral/prepared_reflectance.h"

namespace gonio::bench {
namespace {

using namespace gonio::reflectance;

Estimate estimate_of(const Integral& integral) {
  return {integral.value, integral.evaluations};
}

// `integral(case, incidence, tolerance)` at each tolerance.
template <class F>
Method method(std::string name, Family family, double finest, F integral) {
  const auto rungs = [integral, finest](const Case& c) {
    std::vector<Rung> all;
    for (const double tolerance : tolerance_ladder(finest, 1)) {
      const auto run = [integral, &c, i = c.incidence(), tolerance] { return estimate_of(integral(c, i, tolerance)); };
      all.push_back({tolerance_text(tolerance), repeated(run)});
    }
    return all;
  };
  return {std::move(name), family, rungs};
}

std::vector<Rung> prepared_rungs(const Case& c) {
  std::vector<Rung> all;
  for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
    const auto made = std::make_shared<const PreparedReflectance>(prepared(c, tolerance).reflectance);
    const auto run = [made, i = c.incidence()] { return estimate_of(made->rho_dh(i)); };
    all.push_back({tolerance_text(tolerance), repeated(run)});
  }
  return all;
}

}  // namespace

// Kept from case to case: a surface is prepared once for all its incidences.
const Prepared& prepared(const Case& c, double tolerance) {
  static std::map<std::pair<std::string, double>, Prepared> all;
  const auto key = std::pair{c.surface_name, tolerance};
  const auto found = all.find(key);
  if (found != all.end()) return found->second;
  std::optional<PreparedReflectance> made;
  const double seconds = seconds_of([&] { made = PreparedReflectance::make(c.surface, tolerance).value(); });
  return all.emplace(key, Prepared{*std::move(made), seconds}).first->second;
}

std::vector<double> tolerance_ladder(double finest, int per_decade) {
  std::vector<double> ladder;
  for (int k = per_decade;; ++k) {
    const double tolerance = std::pow(10.0, -static_cast<double>(k) / per_decade);
    if (tolerance < 0.999 * finest) return ladder;
    ladder.push_back(tolerance);
  }
}

std::string tolerance_text(double tolerance) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", tolerance);
  return text;
}

double integrand_in_theta(const Case& c, const Direction& i, double theta, double phi) {
  const Direction r = Direction::from_angles(radians(theta), radians(phi));
  return 2.0 * in_per_steradian(c.surface.eval(i, r)) * r.mu() * r.sin_theta();
}

double integrand_in_mu(const Case& c, const Direction& i, double mu, double phi) {
  const Direction r = Direction::from_cosine(mu, std::sqrt((1.0 - mu) * (1.0 + mu)), radians(phi));
  return 2.0 * in_per_steradian(c.surface.eval(i, r)) * mu;
}

std::vector<Method> our_methods() {
  return {
      {"prepared", Family::Prepared, prepared_rungs},
      method("rho_dh", Family::Ours, 1e-12,
             [](const Case& c, const Direction& i, double t) { return rho_dh(c.surface, i, t); }),
      method("rings in sqrt(mu)", Family::OurPart, 1e-9,
             [](const Case& c, const Direction& i, double t) {
               const auto f = [&](const Direction& r) { return in_per_steradian(c.surface.eval(i, r)); };
               return integrate_hemisphere(f, t, RingSpacing::SqrtMu);
             }),
      method("polar about retro", Family::OurPart, 1e-10,
             [](const Case& c, const Direction& i, double t) { return polar_integral(c.surface, i, i, t); }),
      method("polar about mirror", Family::OurPart, 1e-10,
             [](const Case& c, const Direction& i, double t) { return polar_integral(c.surface, i, mirrored(i), t); }),
  };
}

}  // namespace gonio::bench
