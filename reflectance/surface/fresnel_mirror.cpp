#include "reflectance/surface/fresnel_mirror.h"

#include <array>

namespace gonio::reflectance {
namespace {

constexpr std::array kFresnelMirrorParameters{
    ParameterSpec{
        .name = "refractive_index", .least = 0.1, .most = 1e12, .meaning = "of the far side over the near side"},
};

}  // namespace

constinit const ModelSpec FresnelMirror::kSpec{"fresnel_mirror", "flat, clear interface: mirror part only",
                                               kFresnelMirrorParameters};

Result<FresnelMirror> FresnelMirror::make(FresnelMirrorParameters p) {
  GONIO_TRY(check_values(kSpec, std::array{p.refractive_index}));
  return FresnelMirror(p);
}

double FresnelMirror::specular(const Direction& i) const {
  // Towards the horizon the digits are in mu, towards a critical angle they are in theta.
  const double n = p_.refractive_index;
  return (n >= 1.0 ? fresnel(i.mu(), i.sin_theta(), n) : fresnel(i.theta(), n)).unpolarised();
}

}  // namespace gonio::reflectance
