#pragma once

#include <cmath>
#include <numbers>
#include <string_view>

#include "base/result.h"
#include "reflectance/batch/vector_unit.h"
#include "reflectance/surface/clamped_cosine.h"
#include "reflectance/surface/model_spec.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

struct MinnaertParameters {
  double rho = 0.0;  ///< 0 to 2; pi f at normal incidence and view
  double k = 0.0;    ///< -0.9 to 10; 0 is Lambertian, below 0 brightens towards the horizon
};

/// f_r = rho / pi (mu_i mu_r)^k (Mobley 2005, after Minnaert 1941, whose own exponent is this k + 1).
class Minnaert {
 public:
  static const ModelSpec kSpec;
  /// Errors: InvalidInput.
  [[nodiscard]] static Result<Minnaert> make(MinnaertParameters p);

  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    return per_steradian(p_.rho / std::numbers::pi * std::pow(clamped_mu(i) * clamped_mu(r), p_.k));
  }
  void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f, VectorUnit unit = vector_unit()) const;
  [[nodiscard]] FastPath fast_path() const;
  /// 2 rho mu^k / (k + 2).
  [[nodiscard]] double rho_dh(const Direction& i) const {
    return 2.0 * p_.rho * std::pow(clamped_mu(i), p_.k) / (p_.k + 2.0);
  }
  /// 4 rho / (k + 2)^2.
  [[nodiscard]] double albedo() const { return 4.0 * p_.rho / ((p_.k + 2.0) * (p_.k + 2.0)); }
  /// mu_r = u^(1/(k + 2)) (Mobley 2005, last formula of appendix C).
  [[nodiscard]] DirectionSample sample(const Direction& i, UnitPoint draw) const {
    return {.r = power_cosine_direction(p_.k, draw), .weight = rho_dh(i)};
  }

  [[nodiscard]] std::string_view model() const { return kSpec.name; }
  [[nodiscard]] Parameters parameters() const { return {{"rho", p_.rho}, {"k", p_.k}}; }
  [[nodiscard]] bool is_isotropic() const { return true; }

 private:
  explicit Minnaert(MinnaertParameters p) : p_(p) {}
  MinnaertParameters p_;
};

}  // namespace gonio::reflectance
