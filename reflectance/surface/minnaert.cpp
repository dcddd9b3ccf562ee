#include "reflectance/surface/minnaert.h"

#include <array>

namespace gonio::reflectance {
namespace {

constexpr std::array kMinnaertParameters{
    ParameterSpec{.name = "rho", .least = 0.0, .most = 2.0, .meaning = "pi f at normal incidence and view"},
    ParameterSpec{.name = "k", .least = -0.9, .most = 10.0, .meaning = "exponent of the cosines"},
};

}  // namespace

constinit const ModelSpec Minnaert::kSpec{"minnaert", "rho/pi (mu_i mu_r)^k", kMinnaertParameters};

Result<Minnaert> Minnaert::make(MinnaertParameters p) {
  GONIO_TRY(check_values(kSpec, std::array{p.rho, p.k}));
  return Minnaert(p);
}

}  // namespace gonio::reflectance
