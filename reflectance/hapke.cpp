#include "reflectance/hapke.h"

#include <array>
#include <numbers>

#include "reflectance/gauss_legendre.h"

namespace gonio::reflectance {
namespace {

constexpr std::array kParameters{
    ParameterSpec{.name = "omega0", .least = 0.0, .most = 1.0, .meaning = "single-scattering albedo"},
};

// integral of 1/(1 + b u) over [0, 1] and of u/(1 + b u), with b = 2 gamma in [0, 2].
struct Moments {
  double l1;
  double l2;
};

Moments moments(double b) {
  if (b == 0.0) return {.l1 = 1.0, .l2 = 0.5};
  const double l1 = std::log1p(b) / b;
  if (b >= 0.2) return {.l1 = l1, .l2 = (1.0 - l1) / b};
  // (1 - l1)/b cancels for small b; its series 1/2 - b/3 + b^2/4 - ... does not. 0.2^25 < 1e-17.
  double l2 = 0.0;
  for (int n = 25; n >= 0; --n) l2 = 1.0 / (n + 2.0) - b * l2;
  return {.l1 = l1, .l2 = l2};
}

// integral of (1 + a u) / ((u + mu)(1 + b u)) over [0, 1].
double j_integral(double mu, double a, double b, double l1) {
  const double gap = 1.0 - b * mu;
  if (std::abs(gap) >= 0.05) return ((1.0 - a * mu) * std::log1p(1.0 / mu) + (a - b) * l1) / gap;
  // Partial fractions are 0/0 at b mu = 1. There mu >= 0.475: the integrand is tame, and 30 nodes give all digits.
  static const UnitRule rule = gauss_legendre(30);
  double sum = 0.0;
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    const double u = rule.nodes[k];
    sum += rule.weights[k] * (1.0 + a * u) / ((u + mu) * (1.0 + b * u));
  }
  return sum;
}

}  // namespace

constinit const ModelSpec Hapke::kSpec{"hapke", "isotropic scatterers, eq 7 with Hapke's H", kParameters};
constinit const ModelSpec Hapke::kSpecAsPrinted{"hapke_as_printed", "isotropic scatterers, eq 7 with 1 + mu as printed",
                                                kParameters};

Hapke::Hapke(HapkeParameters p, double one_minus_omega0)
    : p_(p),
      a_(p.form == HapkeForm::Hapke ? 2.0 : 1.0),
      b_(2.0 * std::sqrt(one_minus_omega0)),
      scale_(p.omega0 / (4.0 * std::numbers::pi)) {}

Result<Hapke> Hapke::make(HapkeParameters p) {
  GONIO_TRY(check_values(spec(p.form), std::array{p.omega0}));
  return Hapke(p, 1.0 - p.omega0);
}

Result<Hapke> Hapke::make_from_co_albedo(double one_minus_omega0, HapkeForm form) {
  const HapkeParameters p{.omega0 = 1.0 - one_minus_omega0, .form = form};
  GONIO_TRY(check_values(spec(form), std::array{p.omega0}));
  return Hapke(p, one_minus_omega0);
}

// f mu_r = scale H(mu) h(u) (1 - mu/(u + mu)), integrated over u = mu_r in [0, 1] and 2 pi of azimuth.
double Hapke::rho_dh(const Direction& i) const {
  const double mu = clamped_mu(i);
  const auto [l1, l2] = moments(b_);
  return 0.5 * p_.omega0 * h(mu) * (l1 + a_ * l2 - mu * j_integral(mu, a_, b_, l1));
}

}  // namespace gonio::reflectance
