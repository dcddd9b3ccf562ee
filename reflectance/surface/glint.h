#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/result.h"
#include "reflectance/batch/vector_unit.h"
#include "reflectance/surface/clamped_cosine.h"
#include "reflectance/surface/facet_terms.h"
#include "reflectance/surface/fresnel.h"
#include "reflectance/surface/model_spec.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// Whether facets hide each other.
enum class Shadowing : std::uint8_t {
  None,   ///< as Mobley (2005) uses it; returns more light than comes in towards the horizon
  Smith,  ///< 1 / (1 + Lambda_i + Lambda_r), Smith (1967) with correlated heights
};

struct GlintParameters {
  double slope_variance = 0.0;     ///< sigma^2 of both slope components together, 1e-6 to 1
  double refractive_index = 1.34;  ///< below over above the surface, 1 to 1e12 (which mirrors all but 4e-12)
  Shadowing shadowing = Shadowing::None;
};

/// sigma^2 = 0.003 + 0.00512 W of a sea surface, W the wind at 12.5 m height in m/s (Cox and Munk 1954).
[[nodiscard]] double cox_munk_slope_variance(double wind_m_per_s);

/// Light mirrored by the facets of a rough, clear surface with Gaussian slopes, alike in all azimuths (Cox and Munk
/// 1954; Mobley 2005, section 3): f = R_F(xi/2) p / (4 mu_i mu_r cos^4 beta), p = exp(-tan^2 beta / sigma^2) / (pi
/// sigma^2), beta the tilt of the facet that mirrors i into r. Sea glitter, or with a small variance a glossy paint.
/// Only the reflected light: nothing from below the surface, no foam.
class Glint {
 public:
  static const ModelSpec kSpec;       ///< "glint"
  static const ModelSpec kSpecSmith;  ///< "glint_smith"
  /// Errors: InvalidInput.
  [[nodiscard]] static Result<Glint> make(GlintParameters p);

  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    const double mu_i = clamped_mu(i);
    const double mu_r = clamped_mu(r);
    const FacetTerms t = facet_terms(i, r, mu_i, mu_r);
    const double fresnel_share =
        fresnel(std::sqrt(t.cos2_omega), std::sqrt(1.0 - t.cos2_omega), p_.refractive_index).unpolarised();
    const double per_cos4 = (1.0 + t.tan2_beta) * (1.0 + t.tan2_beta);
    const double facets = peak_ * std::exp(-t.tan2_beta / p_.slope_variance);
    return per_steradian(fresnel_share * facets * per_cos4 / (4.0 * (mu_i * mu_r)) * visible_share(i, r));
  }
  void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f, VectorUnit unit = vector_unit()) const;
  [[nodiscard]] FastPath fast_path() const;

  [[nodiscard]] const GlintParameters& values() const { return p_; }
  /// Smith's Lambda: facets hidden from d by others, per facet seen; 0 at the normal.
  [[nodiscard]] double hidden_ratio(const Direction& d) const;

  [[nodiscard]] std::string_view model() const { return spec(p_.shadowing).name; }
  [[nodiscard]] Parameters parameters() const {
    return {{"slope_variance", p_.slope_variance}, {"refractive_index", p_.refractive_index}};
  }
  [[nodiscard]] bool is_isotropic() const { return true; }
  [[nodiscard]] Feature feature() const { return Feature::Lobe; }

 private:
  explicit Glint(GlintParameters p);
  static const ModelSpec& spec(Shadowing s) { return s == Shadowing::None ? kSpec : kSpecSmith; }

  [[nodiscard]] double visible_share(const Direction& i, const Direction& r) const {
    if (p_.shadowing == Shadowing::None) return 1.0;
    return 1.0 / (1.0 + (hidden_ratio(i) + hidden_ratio(r)));
  }

  void fill_visible_shares(double* shares, const Direction& i, const DirectionBlock& r, VectorUnit unit) const;

  // Where e^-depth comes close to what a double can hold: eval_fast is 0 beyond.
  static constexpr double kDeepest = 700.0;

  GlintParameters p_;
  double peak_;       ///< 1 / (pi sigma^2)
  double deviation_;  ///< sigma
};

}  // namespace gonio::reflectance
