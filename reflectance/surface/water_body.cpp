#include "reflectance/surface/water_body.h"

#include <array>
#include <numbers>

namespace gonio::reflectance {
namespace {

constexpr std::array kWaterBodyParameters{
    ParameterSpec{.name = "rho_w", .least = 0.0, .most = 1.0, .meaning = "share of light sent up below the surface"},
    ParameterSpec{.name = "refractive_index", .least = 1.0, .most = 4.0, .meaning = "of the water"},
};

}  // namespace

constinit const ModelSpec WaterBody::kSpec{"water_body", "light from below a flat water surface", kWaterBodyParameters};

WaterBody::WaterBody(WaterBodyParameters p) : p_(p), entering_(1.0 - fresnel_albedo(p.refractive_index)) {
  const double n2 = p.refractive_index * p.refractive_index;
  // n^2 (1 - A_int rho_w) with A_int = 1 - entering/n^2, which does not cancel for rho_w = 1.
  const double trapped = n2 * (1.0 - p.rho_w) + p.rho_w * entering_;
  scale_ = p.rho_w / (std::numbers::pi * trapped);
  hemispherical_ = p.rho_w * entering_ / trapped;
}

Result<WaterBody> WaterBody::make(WaterBodyParameters p) {
  GONIO_TRY(check_values(kSpec, std::array{p.rho_w, p.refractive_index}));
  return WaterBody(p);
}

}  // namespace gonio::reflectance
