#pragma once

#include <string_view>

#include "base/result.h"
#include "reflectance/batch/vector_unit.h"
#include "reflectance/surface/fresnel.h"
#include "reflectance/surface/model_spec.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

struct FresnelMirrorParameters {
  double refractive_index =
      1.34;  ///< of the far side over the near side, 0.1 to 1e12; below 1 seen from the denser side
};

/// A flat, clear interface (Mobley 2005 eq 9): f = 2 R_F delta(sin^2 t_r - sin^2 t_i) delta(phi_r - phi_i +- pi). All
/// of it is the mirror part: `specular(i)` is R_F, 1 from the critical angle on, and `eval` is 0.
class FresnelMirror {
 public:
  static const ModelSpec kSpec;  ///< "fresnel_mirror"
  /// Errors: InvalidInput.
  [[nodiscard]] static Result<FresnelMirror> make(FresnelMirrorParameters p);

  [[nodiscard]] Brdf eval(const Direction&, const Direction&) const { return {}; }
  void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f, VectorUnit unit = vector_unit()) const;
  [[nodiscard]] FastPath fast_path() const { return {.has_kernel = true}; }
  [[nodiscard]] double rho_dh(const Direction&) const { return 0.0; }
  [[nodiscard]] double specular(const Direction& i) const;
  [[nodiscard]] double albedo() const { return fresnel_albedo(p_.refractive_index); }
  [[nodiscard]] DirectionSample sample(const Direction& i, UnitPoint) const {
    return {.r = mirrored(i), .weight = specular(i), .is_specular = true};
  }

  [[nodiscard]] std::string_view model() const { return kSpec.name; }
  [[nodiscard]] Parameters parameters() const { return {{"refractive_index", p_.refractive_index}}; }
  [[nodiscard]] bool is_isotropic() const { return true; }

 private:
  explicit FresnelMirror(FresnelMirrorParameters p) : p_(p) {}
  FresnelMirrorParameters p_;
};

}  // namespace gonio::reflectance
