#include "reflectance/light/light.h"

#include <cassert>

#include "reflectance/light/brightness.h"

namespace gonio::reflectance {
namespace {

struct RadianceFrom {
  const Direction& i;
  double operator()(const Beam&) const { return 0.0; }
  double operator()(const SunDisk& disk) const { return disk.covers(i) ? disk.radiance() : 0.0; }
  double operator()(const Sky& sky) const { return sky.radiance(i); }
};

}  // namespace

double Light::radiance_from(const Direction& i) const {
  double sum = 0.0;
  for (const LightPart& part : parts_) sum += part.weight * std::visit(RadianceFrom{i}, part.source);
  return sum;
}

Light operator+(Light a, const Light& b) {
  a.parts_.insert(a.parts_.end(), b.parts_.begin(), b.parts_.end());
  return a;
}

Light operator*(double factor, Light light) {
  assert(is_brightness(factor));
  for (LightPart& part : light.parts_) part.weight *= factor;
  return light;
}

}  // namespace gonio::reflectance
