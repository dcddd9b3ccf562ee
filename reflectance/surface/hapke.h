#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "base/result.h"
#include "reflectance/batch/vector_unit.h"
#include "reflectance/surface/chandrasekhar_h.h"
#include "reflectance/surface/clamped_cosine.h"
#include "reflectance/surface/henyey_greenstein.h"
#include "reflectance/surface/model_spec.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// Which function stands for Chandrasekhar's H.
enum class HapkeForm : std::uint8_t {
  Hapke,      ///< (1 + 2 mu) / (1 + 2 gamma mu), Hapke (1981, 1993): a loss-free medium returns its light, to 1.4 %
  AsPrinted,  ///< (1 + mu) / (1 + 2 gamma mu), as Mobley (2005) eq 7 prints it: a loss-free medium returns only 53 %
  Exact,      ///< Chandrasekhar's own
};

struct HapkeParameters {
  double omega0 = 0.0;  ///< single-scattering albedo, 0 to 1
  HapkeForm form = HapkeForm::Hapke;
  double g = 0.0;  ///< -0.999999 to 0.999999; below 0 back-scattering
};

/// A half-space of scatterers with Henyey and Greenstein's phase function P (Hapke 1981; without opposition term):
///   f = omega0/(4 pi) [P(xi) + H(mu_i) H(mu_r) - 1] / (mu_i + mu_r),  gamma = sqrt(1 - omega0);
/// isotropic at g = 0: Mobley (2005) eq 7. Only the first order of scattering knows g. Hapke's H is an approximation:
/// rho_dh exceeds 1 at normal incidence above omega0 = 0.999864. With 1 + mu as printed and g other than 0 the sum goes
/// negative: refused.
class Hapke {
 public:
  static const ModelSpec kSpec;           ///< "hapke", as are the next two isotropic
  static const ModelSpec kSpecAsPrinted;  ///< "hapke_as_printed"
  static const ModelSpec kSpecExact;      ///< "hapke_exact"
  static const ModelSpec kSpecHg;         ///< "hapke_hg", with g
  static const ModelSpec kSpecExactHg;    ///< "hapke_exact_hg", with g
  /// Errors: InvalidInput.
  [[nodiscard]] static Result<Hapke> make(HapkeParameters p);
  /// By 1 - omega0 in [0, 1], which near a loss-free medium has the digits that omega0 lost. Errors: InvalidInput.
  [[nodiscard]] static Result<Hapke> make_from_co_albedo(double one_minus_omega0, HapkeForm form = HapkeForm::Hapke,
                                                         double g = 0.0);

  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    const double mu_i = clamped_mu(i);
    const double mu_r = clamped_mu(r);
    const double orders =
        p_.g == 0.0 ? h_product(mu_i, mu_r) : phase_(i, r, separation_terms(i, r)) + higher_orders(mu_i, mu_r);
    return per_steradian(scale_ * orders / (mu_i + mu_r));
  }
  void eval_fast(const Direction& i, const DirectionBlock& r, BrdfBlock& f, VectorUnit unit = vector_unit()) const;
  [[nodiscard]] FastPath fast_path() const;
  /// At g = 0 closed, to some 1e-15 for all omega0 and mu, the removable pole at 2 gamma mu = 1 included; with the
  /// exact H it is 1 - gamma H(mu).
  [[nodiscard]] std::optional<double> rho_dh(const Direction& i) const;

  [[nodiscard]] std::string_view model() const { return spec(p_).name; }
  [[nodiscard]] Parameters parameters() const;
  [[nodiscard]] bool is_isotropic() const { return true; }
  [[nodiscard]] Feature feature() const;

 private:
  Hapke(HapkeParameters p, double one_minus_omega0);
  static Result<Hapke> make_checked(HapkeParameters p, double one_minus_omega0);
  static const ModelSpec& spec(const HapkeParameters& p);

  [[nodiscard]] double approximate_h(double mu) const { return (1.0 + a_ * mu) / (1.0 + b_ * mu); }
  [[nodiscard]] double h_product(double mu_i, double mu_r) const {
    if (exact_) return std::exp(exact_->log(mu_i) + exact_->log(mu_r));
    return approximate_h(mu_i) * approximate_h(mu_r);
  }
  /// H H - 1 without the subtraction: all there is beside a phase function of which only its dim side is seen.
  [[nodiscard]] double higher_orders(double mu_i, double mu_r) const {
    if (exact_) return std::expm1(exact_->log(mu_i) + exact_->log(mu_r));
    const double more_i = rise_ * mu_i / (1.0 + b_ * mu_i);
    const double more_r = rise_ * mu_r / (1.0 + b_ * mu_r);
    return more_i + more_r + more_i * more_r;
  }

  void fill_higher_orders(double* orders, const Direction& i, const DirectionBlock& r, VectorUnit unit) const;

  HapkeParameters p_;
  HenyeyGreenstein phase_;
  double a_;      ///< 2 or 1
  double b_;      ///< 2 gamma
  double rise_;   ///< 2 - 2 gamma: H - 1 = rise mu / (1 + b mu) in Hapke's form
  double scale_;  ///< omega0 / (4 pi)
  std::optional<ChandrasekharH> exact_;
};

}  // namespace gonio::reflectance
