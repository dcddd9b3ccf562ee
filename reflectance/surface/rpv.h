#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/result.h"
#include "reflectance/batch/vector_unit.h"
#include "reflectance/surface/clamped_cosine.h"
#include "reflectance/surface/henyey_greenstein.h"
#include "reflectance/surface/model_spec.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// What the right side of eq 8 is read as.
enum class RpvNorm : std::uint8_t {
  Brdf,  ///< the BRDF itself, as Mobley (2005) eq 8 prints it
  Brf,   ///< pi times the BRDF, a reflectance factor, as Rahman et al. (1993) define it
};

struct RpvParameters {
  double rho0 = 0.0;  ///< 0 to 1; level
  double k = 1.0;     ///< 0 to 2; below 1 a bowl, above 1 a bell
  double g = 0.0;     ///< -0.999999 to 0.999999; below 0 back-scattering
  RpvNorm norm = RpvNorm::Brdf;
};

/// Rahman, Pinty and Verstraete (1993) for canopies and soils; Mobley (2005) eq 8:
///   f = rho0 (mu_i mu_r (mu_i + mu_r))^(k-1) F(xi) (1 + (1 - rho0)/(1 + G)),
///   F = (1 - g^2) / (1 + g^2 + 2 g cos xi)^1.5,  G as in direction.h.
/// A hot spot at retro-reflection. As a BRDF it breaks energy towards the horizon (wheat: rho_dh > 1 beyond 89.516
/// deg).
class Rpv {
 public:
  static const ModelSpec kSpec;     ///< "rpv", norm Brdf
  static const ModelSpec kSpecBrf;  ///< "rpv_brf", norm Brf
  /// Errors: InvalidInput.
  [[nodiscard]] static Result<Rpv> make(RpvParameters p);

  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    const double mu_i = clamped_mu(i);
    const double mu_r = clamped_mu(r);
    const double product = mu_i * mu_r;
    const SeparationTerms t = separation_terms(i, r);
    const double hot_spot = 1.0 + (1.0 - p_.rho0) / (1.0 + retro_distance(t, product));
    return per_steradian(scale_ * std::pow(product * (mu_i + mu_r), p_.k - 1.0) * phase_(i, r, t) * hot_spot);
  }
  void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f, VectorUnit unit = vector_unit()) const;
  [[nodiscard]] FastPath fast_path() const;

  [[nodiscard]] std::string_view model() const { return p_.norm == RpvNorm::Brdf ? kSpec.name : kSpecBrf.name; }
  [[nodiscard]] Parameters parameters() const { return {{"rho0", p_.rho0}, {"k", p_.k}, {"g", p_.g}}; }
  [[nodiscard]] bool is_isotropic() const { return true; }
  [[nodiscard]] Feature feature() const { return Feature::HotSpot; }

 private:
  explicit Rpv(RpvParameters p);
  RpvParameters p_;
  HenyeyGreenstein phase_;  ///< F
  double scale_;            ///< rho0, by pi for Brf
};

}  // namespace gonio::reflectance
