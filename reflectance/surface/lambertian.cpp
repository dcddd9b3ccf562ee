#include "reflectance/surface/lambertian.h"

#include <array>

namespace gonio::reflectance {
namespace {

constexpr std::array kLambertianParameters{
    ParameterSpec{.name = "rho", .least = 0.0, .most = 1.0, .meaning = "share of light sent back"},
};

}  // namespace

constinit const ModelSpec Lambertian::kSpec{"lambertian", "the same radiance in all directions", kLambertianParameters};

Result<Lambertian> Lambertian::make(LambertianParameters p) {
  GONIO_TRY(check_values(kSpec, std::array{p.rho}));
  return Lambertian(p);
}

}  // namespace gonio::reflectance
