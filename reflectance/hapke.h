#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/result.h"
#include "reflectance/clamped_cosine.h"
#include "reflectance/model_spec.h"
#include "reflectance/surface.h"

namespace gonio::reflectance {

/// Which function stands for Chandrasekhar's H.
enum class HapkeForm : std::uint8_t {
  Hapke,      ///< (1 + 2 mu) / (1 + 2 gamma mu), Hapke (1981, 1993): a loss-free medium returns its light, to 1.4 %
  AsPrinted,  ///< (1 + mu) / (1 + 2 gamma mu), as Mobley (2005) eq 7 prints it: a loss-free medium returns only 53 %
};

struct HapkeParameters {
  double omega0 = 0.0;  ///< single-scattering albedo, 0 to 1
  HapkeForm form = HapkeForm::Hapke;
};

/// A half-space of isotropic scatterers, Mobley (2005) eq 7: f = omega0/(4 pi) H(mu_i) H(mu_r) / (mu_i + mu_r),
/// gamma = sqrt(1 - omega0). Hapke's H is an approximation: rho_dh exceeds 1 at normal incidence above omega0 =
/// 0.999864.
class Hapke {
 public:
  static const ModelSpec kSpec;           ///< "hapke"
  static const ModelSpec kSpecAsPrinted;  ///< "hapke_as_printed"
  /// Errors: InvalidInput.
  [[nodiscard]] static Result<Hapke> make(HapkeParameters p);
  /// By 1 - omega0 in [0, 1], which near a loss-free medium has the digits that omega0 lost. Errors: InvalidInput.
  [[nodiscard]] static Result<Hapke> make_from_co_albedo(double one_minus_omega0, HapkeForm form = HapkeForm::Hapke);

  [[nodiscard]] double h(double mu) const { return (1.0 + a_ * mu) / (1.0 + b_ * mu); }
  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    const double mu_i = clamped_mu(i);
    const double mu_r = clamped_mu(r);
    return per_steradian(scale_ * (h(mu_i) * h(mu_r)) / (mu_i + mu_r));
  }
  /// Closed, to some 1e-15 for all omega0 and mu, the removable pole at 2 gamma mu = 1 included.
  [[nodiscard]] double rho_dh(const Direction& i) const;

  [[nodiscard]] std::string_view model() const { return spec(p_.form).name; }
  [[nodiscard]] Parameters parameters() const { return {{"omega0", p_.omega0}}; }
  [[nodiscard]] bool is_isotropic() const { return true; }

 private:
  Hapke(HapkeParameters p, double one_minus_omega0);
  static const ModelSpec& spec(HapkeForm form) { return form == HapkeForm::Hapke ? kSpec : kSpecAsPrinted; }

  HapkeParameters p_;
  double a_;      ///< 2 or 1
  double b_;      ///< 2 gamma
  double scale_;  ///< omega0 / (4 pi)
};

}  // namespace gonio::reflectance
