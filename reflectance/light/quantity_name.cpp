#include "reflectance/light/quantity_name.h"

#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

namespace gonio::reflectance {
namespace {

constexpr std::string_view kMobley = "Mobley (2005)";
constexpr std::string_view kNicodemus = "Nicodemus et al. (1977)";
constexpr std::string_view kHapke = "Hapke (1993)";
constexpr std::string_view kNeedsBody = "a property of a whole planet, not of its surface";

constexpr std::array kNames{
    QuantityName{"brdf", "f", "sr^-1", "dL_r / (L_i mu_i dOmega_i)", kNicodemus},
    QuantityName{"radiance_reflectance", "r", "sr^-1", "f mu_i", kMobley},
    QuantityName{"reff", "REFF", "1", "pi f", kHapke},
    QuantityName{"radf_normal_incidence", "RADF", "1", "pi f at theta_i = 0", kMobley},
    QuantityName{"i_over_f", "I/F", "1", "pi f mu_i", kHapke},
    QuantityName{"rho_dh", "rho_dh", "1", "integral of f mu_r dOmega_r", kNicodemus},
    QuantityName{"rho_hd", "rho_hd", "1", "integral of f mu_i dOmega_i", kNicodemus},
    QuantityName{"plane_albedo", "A_pl", "1", "rho_dh", kMobley},
    QuantityName{"normal_albedo", "A_n", "1", "pi f at xi = 0", kHapke},
    QuantityName{"spherical_albedo", "A", "1", "(1/pi) integral of rho_dh mu_i dOmega_i", kMobley},
    QuantityName{"bond_albedo", "A", "1", "spherical_albedo", kHapke},
    QuantityName{"irradiance_reflectance", "R", "1", "E_u / E_d", kMobley},
    QuantityName{"remote_sensing_reflectance", "R_rs", "sr^-1", "L_r / E_d", kMobley},
    QuantityName{"remote_sensing_reflectance_water", "R_rs,w", "sr^-1", "L_w / E_d, of what leaves the water", kMobley},
    QuantityName{"radf", "RADF", "1", "", kHapke,
                 "books disagree: ask for radf_normal_incidence (pi f at theta_i = 0) or i_over_f (pi f mu_i)"},
    QuantityName{
        "albedo", "", "1", "", kHapke,
        "has too many meanings: ask for plane_albedo, normal_albedo, spherical_albedo or irradiance_reflectance"},
    QuantityName{"hemispherical_albedo", "A_h", "1", "", kHapke, "ask for plane_albedo: the same integral"},
    QuantityName{"physical_albedo", "A_p", "1", "", kHapke, kNeedsBody},
    QuantityName{"geometric_albedo", "A_p", "1", "", kHapke, kNeedsBody},
    QuantityName{"single_scattering_albedo", "w", "1", "", kHapke,
                 "a property of the grains, not of their surface: the parameter omega0 of the hapke models"},
};

Error unknown_name(std::string_view name) {
  std::string known;
  for (const QuantityName& q : kNames) {
    if (q.is_supported()) known += fmt::format("{}{}", known.empty() ? "" : ", ", q.name);
  }
  return {.code = ErrorCode::InvalidInput,
          .tried = fmt::format("find the reflectance {}", name),
          .seen = "no such name",
          .limit = "one of " + known,
          .where = InputLocation{.file = {}, .field = "quantity"}};
}

}  // namespace

std::span<const QuantityName> quantity_names() {
  return kNames;
}

Result<QuantityName> find_quantity(std::string_view name) {
  const auto found = std::ranges::find(kNames, name, &QuantityName::name);
  if (found == kNames.end()) return failure(unknown_name(name));
  if (found->is_supported()) return *found;
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = fmt::format("find the reflectance {}", name),
                  .seen = "a name that is not supported",
                  .limit = std::string(found->why_not),
                  .where = InputLocation{.file = {}, .field = "quantity"}});
}

}  // namespace gonio::reflectance
