#include "reflectance/surface/rpv.h"

#include <array>
#include <numbers>

namespace gonio::reflectance {
namespace {

constexpr std::array kRpvParameters{
    ParameterSpec{.name = "rho0", .least = 0.0, .most = 1.0, .meaning = "level"},
    ParameterSpec{.name = "k", .least = 0.0, .most = 2.0, .meaning = "bowl (below 1) or bell (above 1)"},
    ParameterSpec{.name = "g", .least = -0.999999, .most = 0.999999, .meaning = "asymmetry, below 0 back-scattering"},
};

}  // namespace

constinit const ModelSpec Rpv::kSpec{"rpv", "Rahman-Pinty-Verstraete, eq 8 read as a BRDF", kRpvParameters};
constinit const ModelSpec Rpv::kSpecBrf{"rpv_brf", "Rahman-Pinty-Verstraete, eq 8 read as pi times the BRDF",
                                        kRpvParameters};

Rpv::Rpv(RpvParameters p) : p_(p), phase_(p.g), scale_(p.norm == RpvNorm::Brf ? p.rho0 / std::numbers::pi : p.rho0) {}

Result<Rpv> Rpv::make(RpvParameters p) {
  GONIO_TRY(check_values(p.norm == RpvNorm::Brdf ? kSpec : kSpecBrf, std::array{p.rho0, p.k, p.g}));
  return Rpv(p);
}

}  // namespace gonio::reflectance
