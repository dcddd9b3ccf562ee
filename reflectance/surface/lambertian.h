#pragma once

#include <numbers>
#include <string_view>

#include "base/result.h"
#include "reflectance/batch/vector_unit.h"
#include "reflectance/surface/model_spec.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

struct LambertianParameters {
  double rho = 0.0;  ///< the share of light that is sent back, 0 to 1
};

/// f_r = rho / pi, the same in all directions (Mobley 2005 eq 5).
class Lambertian {
 public:
  static const ModelSpec kSpec;
  /// Errors: InvalidInput.
  [[nodiscard]] static Result<Lambertian> make(LambertianParameters p);

  [[nodiscard]] Brdf eval(const Direction&, const Direction&) const { return f_; }
  void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f, VectorUnit unit = vector_unit()) const;
  [[nodiscard]] FastPath fast_path() const { return {.has_kernel = true}; }
  [[nodiscard]] double rho_dh(const Direction&) const { return p_.rho; }
  [[nodiscard]] double albedo() const { return p_.rho; }
  [[nodiscard]] DirectionSample sample(const Direction&, UnitPoint draw) const {
    return {.r = power_cosine_direction(0.0, draw), .weight = p_.rho};
  }

  [[nodiscard]] std::string_view model() const { return kSpec.name; }
  [[nodiscard]] Parameters parameters() const { return {{"rho", p_.rho}}; }
  [[nodiscard]] bool is_isotropic() const { return true; }

 private:
  explicit Lambertian(LambertianParameters p) : p_(p), f_(per_steradian(p.rho / std::numbers::pi)) {}
  LambertianParameters p_;
  Brdf f_;
};

}  // namespace gonio::reflectance
