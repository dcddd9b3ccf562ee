#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "base/result.h"
#include "reflectance/surface/clamped_cosine.h"
#include "reflectance/surface/facet_terms.h"
#include "reflectance/surface/fresnel.h"
#include "reflectance/surface/model_spec.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

struct GgxParameters {
  double roughness = 0.1;  ///< alpha, 0.001 to 1: the slope at which the density of facets has fallen to a fourth
  double refractive_index = 1.5;  ///< below over above the surface, 1 to 1e12 (which mirrors all but 4e-12)
};

/// The parameters of facets by their roughness, whichever their slopes.
inline constexpr std::array kFacetParameters{
    ParameterSpec{.name = "roughness", .least = 1e-3, .most = 1.0, .meaning = "alpha, of the facets' slopes"},
    ParameterSpec{.name = "refractive_index", .least = 1.0, .most = 1e12, .meaning = "below over above the surface"},
};

/// Light mirrored by facets whose slopes have a long tail (Trowbridge and Reitz 1975; GGX of Walter, Marschner, Li and
/// Torrance 2007, eq 33), with Smith's shadowing for correlated heights (Heitz 2014, eq 99):
///   f = R_F(xi/2) D G / (4 mu_i mu_r),  D = alpha^2 / (pi cos^4 beta (alpha^2 + tan^2 beta)^2),
///   G = 1 / (1 + Lambda_i + Lambda_r),  Lambda = (sqrt(1 + alpha^2 tan^2 theta) - 1) / 2.
/// Only the first bounce: a rough mirror gives back less than it gets. Gaussian slopes (Beckmann 1963) with the same
/// shadowing are Glint with slope_variance = alpha^2, which `make_surface` knows as "beckmann", too.
class Ggx {
 public:
  static const ModelSpec kSpec;  ///< "ggx"
  /// Errors: InvalidInput.
  [[nodiscard]] static Result<Ggx> make(GgxParameters p);

  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    const double mu_i = clamped_mu(i);
    const double mu_r = clamped_mu(r);
    const FacetTerms t = facet_terms(i, r, mu_i, mu_r);
    const double fresnel_share =
        fresnel(std::sqrt(t.cos2_omega), std::sqrt(1.0 - t.cos2_omega), p_.refractive_index).unpolarised();
    const double fall = (1.0 + t.tan2_beta) / (1.0 + t.tan2_beta / alpha2_);
    // G / (4 mu_i mu_r) with the cosines multiplied out, so that the horizon divides nothing by 0.
    const double seen = 2.0 * (mu_r * masked_mu(mu_i, i) + mu_i * masked_mu(mu_r, r));
    return per_steradian(fresnel_share * peak_ * (fall * fall) / seen);
  }

  [[nodiscard]] const GgxParameters& values() const { return p_; }
  [[nodiscard]] std::string_view model() const { return kSpec.name; }
  [[nodiscard]] Parameters parameters() const {
    return {{"roughness", p_.roughness}, {"refractive_index", p_.refractive_index}};
  }
  [[nodiscard]] bool is_isotropic() const { return true; }
  [[nodiscard]] Feature feature() const { return Feature::Lobe; }

 private:
  explicit Ggx(GgxParameters p)
      : p_(p), alpha2_(p.roughness * p.roughness), peak_(1.0 / (std::numbers::pi * alpha2_)) {}

  // mu sqrt(1 + alpha^2 tan^2 theta).
  [[nodiscard]] double masked_mu(double mu, const Direction& d) const {
    return std::sqrt(mu * mu + alpha2_ * (d.sin_theta() * d.sin_theta()));
  }

  GgxParameters p_;
  double alpha2_;
  double peak_;  ///< 1 / (pi alpha^2)
};

}  // namespace gonio::reflectance
