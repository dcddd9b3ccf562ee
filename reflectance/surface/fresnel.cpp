#include "reflectance/surface/fresnel.h"

#include <cassert>
#include <cmath>

#include "reflectance/integral/compensated_sum.h"
#include "reflectance/integral/tanh_sinh.h"

namespace gonio::reflectance {
namespace {

// From the thinner side a sum of two positive parts, which keeps its digits at grazing incidence with n close to 1.
double squared_refracted_cosine(double cos_theta, double sin_theta, double n) {
  if (n >= 1.0) return ((n - 1.0) * (n + 1.0) + cos_theta * cos_theta) / (n * n);
  return (1.0 - sin_theta / n) * (1.0 + sin_theta / n);
}

// t2: squared cosine of the refracted direction, <= 0 from the critical angle on.
FresnelReflectance from_cosines(double cos_theta, double sin_theta, double n, double t2) {
  if (t2 <= 0.0) return {.s = 1.0, .p = 1.0};
  const double t = std::sqrt(t2);
  const double across = cos_theta + n * t;
  const double in_plane = n * cos_theta + t;
  const double ratio = sin_theta / n;
  const double contrast = (1.0 - n) * (1.0 + n);
  const double r_s = contrast / (across * across);
  const double r_p = -contrast * (cos_theta - ratio) * (cos_theta + ratio) / (in_plane * in_plane);
  return {.s = r_s * r_s, .p = r_p * r_p};
}

}  // namespace

FresnelReflectance fresnel(double cos_theta, double sin_theta, double n) {
  assert(n > 0.0 && std::isfinite(n) && cos_theta >= 0.0 && sin_theta >= 0.0);
  return from_cosines(cos_theta, sin_theta, n, squared_refracted_cosine(cos_theta, sin_theta, n));
}

FresnelReflectance fresnel(Angle theta, double n) {
  assert(n > 0.0 && std::isfinite(n) && theta.si() >= 0.0 && theta.si() < 1.6);
  const double cos_theta = std::cos(theta.si());
  const double sin_theta = std::sin(theta.si());
  if (n >= 1.0) return fresnel(std::abs(cos_theta), sin_theta, n);
  const double critical = std::asin(n);
  const double t2 = std::sin(critical - theta.si()) * std::sin(critical + theta.si()) / (n * n);
  return from_cosines(cos_theta, sin_theta, n, t2);
}

double fresnel_transmittance(double cos_theta, double sin_theta, double n) {
  assert(n > 0.0 && std::isfinite(n) && cos_theta >= 0.0 && sin_theta >= 0.0);
  const double t2 = squared_refracted_cosine(cos_theta, sin_theta, n);
  if (t2 <= 0.0) return 0.0;
  const double t = std::sqrt(t2);
  const double across = cos_theta + n * t;
  const double in_plane = n * cos_theta + t;
  return 2.0 * n * cos_theta * t * (1.0 / (across * across) + 1.0 / (in_plane * in_plane));
}

double fresnel_albedo(double n) {
  assert(n > 0.0 && std::isfinite(n));
  if (n < 1.0) return 1.0 - (1.0 - fresnel_albedo(1.0 / n)) * n * n;
  CompensatedSum sum;
  for (const EndNode& node : tanh_sinh(5)) {  // the ends take up the root at grazing incidence, sharp for n close to 1
    const double sin_theta = std::sqrt(node.rest * (1.0 + node.x));
    sum.add(2.0 * node.weight * node.x * fresnel(node.x, sin_theta, n).unpolarised());
  }
  return sum.value();
}

}  // namespace gonio::reflectance
