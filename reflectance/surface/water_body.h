#pragma once

#include <algorithm>
#include <string_view>

#include "base/result.h"
#include "reflectance/batch/vector_unit.h"
#include "reflectance/surface/clamped_cosine.h"
#include "reflectance/surface/fresnel.h"
#include "reflectance/surface/model_spec.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

struct WaterBodyParameters {
  double rho_w = 0.0;              ///< share of the light below the surface that the water sends up again, 0 to 1
  double refractive_index = 1.34;  ///< 1 to 4
};

/// The light that comes back out of water under a flat surface, the water below being Lambertian and all reflections
/// between it and the surface counted: f_w = T(t_i) T(t_r) rho_w / (pi n^2 (1 - A_int rho_w)), T = 1 - R_F. It lacks
/// what the surface itself mirrors: add a FresnelMirror or a Glint.
class WaterBody {
 public:
  static const ModelSpec kSpec;  ///< "water_body"
  /// Errors: InvalidInput.
  [[nodiscard]] static Result<WaterBody> make(WaterBodyParameters p);

  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    return per_steradian(scale_ * (passed(i) * passed(r)));
  }
  void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f, VectorUnit unit = vector_unit()) const;
  [[nodiscard]] FastPath fast_path() const { return {.has_kernel = true}; }
  /// T(t_i) rho_w (1 - A_ext) / (n^2 (1 - A_int rho_w)): T(t_i) for a loss-free body.
  [[nodiscard]] double rho_dh(const Direction& i) const { return hemispherical_ * passed(i); }
  /// Of isotropic light 1 - A_ext passes.
  [[nodiscard]] double albedo() const { return hemispherical_ * entering_; }

  [[nodiscard]] std::string_view model() const { return kSpec.name; }
  [[nodiscard]] Parameters parameters() const {
    return {{"rho_w", p_.rho_w}, {"refractive_index", p_.refractive_index}};
  }
  [[nodiscard]] bool is_isotropic() const { return true; }

 private:
  explicit WaterBody(WaterBodyParameters p);
  [[nodiscard]] double passed(const Direction& d) const {
    return fresnel_transmittance(clamped_mu(d), d.sin_theta(), p_.refractive_index);
  }

  WaterBodyParameters p_;
  double entering_;       ///< 1 - A_ext
  double scale_;          ///< f_w / (T T)
  double hemispherical_;  ///< rho_dh / T
};

}  // namespace gonio::reflectance
