#include "reflectance/surface/hapke.h"

#include <array>
#include <numbers>
#include <span>

#include <fmt/format.h>

#include "reflectance/integral/gauss_legendre.h"

namespace gonio::reflectance {
namespace {

constexpr ParameterSpec kOmega0{.name = "omega0", .least = 0.0, .most = 1.0, .meaning = "single-scattering albedo"};
constexpr std::array kIsotropic{kOmega0};
constexpr std::array kWithPhase{
    kOmega0,
    ParameterSpec{.name = "g", .least = -0.999999, .most = 0.999999, .meaning = "asymmetry, below 0 back-scattering"},
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

constinit const ModelSpec Hapke::kSpec{"hapke", "isotropic scatterers, eq 7 with Hapke's H", kIsotropic};
constinit const ModelSpec Hapke::kSpecAsPrinted{"hapke_as_printed", "isotropic scatterers, eq 7 with 1 + mu as printed",
                                                kIsotropic};
constinit const ModelSpec Hapke::kSpecExact{"hapke_exact", "isotropic scatterers, eq 7 with Chandrasekhar's H",
                                            kIsotropic};
constinit const ModelSpec Hapke::kSpecHg{"hapke_hg", "Henyey-Greenstein scatterers with Hapke's H", kWithPhase};
constinit const ModelSpec Hapke::kSpecExactHg{"hapke_exact_hg", "Henyey-Greenstein scatterers with Chandrasekhar's H",
                                              kWithPhase};

const ModelSpec& Hapke::spec(const HapkeParameters& p) {
  switch (p.form) {
    case HapkeForm::AsPrinted:
      return kSpecAsPrinted;
    case HapkeForm::Exact:
      return p.g == 0.0 ? kSpecExact : kSpecExactHg;
    case HapkeForm::Hapke:
      break;
  }
  return p.g == 0.0 ? kSpec : kSpecHg;
}

Hapke::Hapke(HapkeParameters p, double one_minus_omega0)
    : p_(p),
      phase_(p.g),
      a_(p.form == HapkeForm::AsPrinted ? 1.0 : 2.0),
      b_(2.0 * std::sqrt(one_minus_omega0)),
      rise_(p.omega0 / (0.5 + 0.25 * b_)),
      scale_(p.omega0 / (4.0 * std::numbers::pi)) {
  if (p.form == HapkeForm::Exact) exact_.emplace(one_minus_omega0);
}

Result<Hapke> Hapke::make(HapkeParameters p) {
  return make_checked(p, 1.0 - p.omega0);
}

Result<Hapke> Hapke::make_from_co_albedo(double one_minus_omega0, HapkeForm form, double g) {
  // omega0 hides a loss just below 0, whose root is no number.
  if (!(one_minus_omega0 >= 0.0 && one_minus_omega0 <= 1.0)) {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "make a surface \"hapke\"",
                    .seen = fmt::format("1 - omega0 = {}", one_minus_omega0),
                    .limit = "0 to 1",
                    .where = InputLocation{.file = {}, .field = "omega0"}});
  }
  return make_checked({.omega0 = 1.0 - one_minus_omega0, .form = form, .g = g}, one_minus_omega0);
}

Result<Hapke> Hapke::make_checked(HapkeParameters p, double one_minus_omega0) {
  const std::array values{p.omega0, p.g};
  GONIO_TRY(check_values(spec(p), std::span(values).first(spec(p).parameters.size())));
  if (p.form == HapkeForm::AsPrinted && p.g != 0.0) {
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = "make a surface \"hapke_as_printed\"",
                    .seen = fmt::format("g = {}", p.g),
                    .limit = "0: with 1 + mu as printed and any other g the BRDF goes negative",
                    .where = InputLocation{.file = {}, .field = "g"}});
  }
  return Hapke(p, one_minus_omega0);
}

Parameters Hapke::parameters() const {
  Parameters parameters{{"omega0", p_.omega0}};
  if (p_.g != 0.0) parameters.push_back({"g", p_.g});
  return parameters;
}

// A peaked phase function: its forward peak lies below the horizon, closest to the mirror direction.
Feature Hapke::feature() const {
  if (p_.g < -0.5) return Feature::HotSpot;
  return p_.g > 0.5 ? Feature::Lobe : Feature::Smooth;
}

// f mu_r = scale H(mu) h(u) (1 - mu/(u + mu)), integrated over u = mu_r in [0, 1] and 2 pi of azimuth.
std::optional<double> Hapke::rho_dh(const Direction& i) const {
  if (p_.g != 0.0) return std::nullopt;
  const double mu = clamped_mu(i);
  if (exact_) {
    // 1 - gamma H as (1 - gamma) - gamma (H - 1): a dark medium keeps its digits.
    const double gamma = 0.5 * b_;
    return p_.omega0 / (1.0 + gamma) - gamma * std::expm1(exact_->log(mu));
  }
  const auto [l1, l2] = moments(b_);
  return 0.5 * p_.omega0 * approximate_h(mu) * (l1 + a_ * l2 - mu * j_integral(mu, a_, b_, l1));
}

}  // namespace gonio::reflectance
