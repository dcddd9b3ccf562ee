#include "reflectance/fit/fit_formula.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gonio::fit {
namespace {

constexpr double kPi = std::numbers::pi;
using Numbers = std::span<const double>;

Dual square_of(const Dual& x) {
  return x * x;
}

// (1 - g^2) / (1 + g^2 + 2 g cos xi)^1.5.
Dual henyey_greenstein(const Dual& g, double cos_xi) {
  const Dual base = 1.0 + g * g + 2.0 * cos_xi * g;
  return (1.0 - g * g) / (base * sqrt(base));
}

// The unpolarised reflectance in the cosine form, as surface/fresnel.h has it.
Dual fresnel_share(double c, const Dual& n) {
  const double s2 = 1.0 - c * c;
  const Dual n2 = n * n;
  const Dual t = sqrt(1.0 - s2 / n2);
  const Dual s = (1.0 - n2) / square_of(c + n * t);
  const Dual p = (n2 - 1.0) * (c * c - s2 / n2) / square_of(n * c + t);
  return 0.5 * (s * s + p * p);
}

// Smith's Lambda of Gaussian slopes, v = cot(theta) / sigma.
Dual hidden_by_gaussian(double mu, double sin_theta, const Dual& deviation) {
  if (mu > 6.0 * deviation.v * sin_theta) return {};
  const Dual v = mu / (deviation * sin_theta);
  return 0.5 * (exp(-(v * v)) / (v * std::sqrt(kPi)) - erfc(v));
}

Dual gaussian_facets(const PairTerms& p, const Dual& variance, const Dual& n, bool is_shadowed) {
  const double per_cos4 = (1.0 + p.tan2_beta) * (1.0 + p.tan2_beta);
  const Dual f = fresnel_share(p.cos_omega, n) * exp(-p.tan2_beta / variance) * per_cos4 /
                 (4.0 * kPi * p.mu_i * p.mu_r * variance);
  if (!is_shadowed) return f;
  const Dual deviation = sqrt(variance);
  return f / (1.0 + (hidden_by_gaussian(p.mu_i, p.sin_i, deviation) + hidden_by_gaussian(p.mu_r, p.sin_r, deviation)));
}

Dual lambertian(const PairTerms&, Numbers x) {
  return Dual::parameter(x[0], 0) / kPi;
}

Dual minnaert(const PairTerms& p, Numbers x) {
  return Dual::parameter(x[0], 0) / kPi * pow(p.mu_i * p.mu_r, Dual::parameter(x[1], 1));
}

// H = (1 + a mu) / (1 + 2 gamma mu); with a phase function beside the higher orders.
Dual hapke_orders(const PairTerms& p, Numbers x, double a) {
  const Dual omega0 = Dual::parameter(x[0], 0);
  const Dual b = 2.0 * sqrt(1.0 - omega0);
  const Dual h = (1.0 + a * p.mu_i) * (1.0 + a * p.mu_r) / ((1.0 + b * p.mu_i) * (1.0 + b * p.mu_r));
  const Dual orders = x.size() > 1 ? henyey_greenstein(Dual::parameter(x[1], 1), p.cos_xi) + h - 1.0 : h;
  return omega0 / (4.0 * kPi) * orders / (p.mu_i + p.mu_r);
}

Dual hapke(const PairTerms& p, Numbers x) {
  return hapke_orders(p, x, 2.0);
}

Dual hapke_as_printed(const PairTerms& p, Numbers x) {
  return hapke_orders(p, x, 1.0);
}

Dual rpv(const PairTerms& p, Numbers x) {
  const Dual rho0 = Dual::parameter(x[0], 0);
  const Dual k = Dual::parameter(x[1], 1);
  const Dual g = Dual::parameter(x[2], 2);
  const Dual hot_spot = 1.0 + (1.0 - rho0) / (1.0 + p.retro_distance);
  return rho0 * pow(p.mu_i * p.mu_r * (p.mu_i + p.mu_r), k - 1.0) * henyey_greenstein(g, p.cos_xi) * hot_spot;
}

Dual rpv_brf(const PairTerms& p, Numbers x) {
  return rpv(p, x) / kPi;
}

Dual sea_variance(Numbers x) {
  return (3.0 + 5.12 * Dual::parameter(x[0], 0)) / 1000.0;
}

Dual cox_munk(const PairTerms& p, Numbers x) {
  return gaussian_facets(p, sea_variance(x), Dual::parameter(x[1], 1), false);
}

Dual cox_munk_smith(const PairTerms& p, Numbers x) {
  return gaussian_facets(p, sea_variance(x), Dual::parameter(x[1], 1), true);
}

Dual glint_smith(const PairTerms& p, Numbers x) {
  return gaussian_facets(p, Dual::parameter(x[0], 0), Dual::parameter(x[1], 1), true);
}

Dual beckmann(const PairTerms& p, Numbers x) {
  return gaussian_facets(p, square_of(Dual::parameter(x[0], 0)), Dual::parameter(x[1], 1), true);
}

Dual ggx(const PairTerms& p, Numbers x) {
  const Dual alpha2 = square_of(Dual::parameter(x[0], 0));
  const Dual fall = (1.0 + p.tan2_beta) / (1.0 + p.tan2_beta / alpha2);
  const auto masked = [&](double mu, double sin_theta) { return sqrt(mu * mu + alpha2 * (sin_theta * sin_theta)); };
  const Dual seen = 2.0 * (p.mu_r * masked(p.mu_i, p.sin_i) + p.mu_i * masked(p.mu_r, p.sin_r));
  return fresnel_share(p.cos_omega, Dual::parameter(x[1], 1)) * fall * fall / (kPi * alpha2 * seen);
}

// Of isotropic light from above, unpolarised (Walsh 1926, Duntley 1942).
Dual walsh_albedo(const Dual& n) {
  const Dual n2 = n * n;
  const Dual n4 = n2 * n2;
  const Dual sum = n2 + 1.0;
  const Dual difference = n4 - 1.0;
  return 0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * square_of(n + 1.0)) +
         n2 * square_of(n2 - 1.0) / (sum * sum * sum) * log((n - 1.0) / (n + 1.0)) -
         2.0 * n * n2 * (n2 + 2.0 * n - 1.0) / (sum * difference) +
         8.0 * n4 * (n4 + 1.0) / (sum * difference * difference) * log(n);
}

Dual water_body(const PairTerms& p, Numbers x) {
  const Dual rho = Dual::parameter(x[0], 0);
  const Dual n = Dual::parameter(x[1], 1);
  const Dual passed = (1.0 - fresnel_share(p.mu_i, n)) * (1.0 - fresnel_share(p.mu_r, n));
  // n^2 (1 - A_int rho) with A_int = 1 - (1 - A_ext)/n^2.
  return passed * rho / (kPi * (n * n * (1.0 - rho) + rho * (1.0 - walsh_albedo(n))));
}

constexpr FormulaParameter kOmega0{.name = "omega0", .start = 0.8, .least = 0.0, .most = 0.999999};
constexpr FormulaParameter kAsymmetry{.name = "g", .start = -0.1, .least = -0.95, .most = 0.95};
constexpr FormulaParameter kIndex{.name = "refractive_index", .start = 1.5, .least = 1.01, .most = 4.0};
constexpr FormulaParameter kWaterIndex{
    .name = "refractive_index", .start = 1.34, .least = 1.01, .most = 4.0, .is_fixed = true};
constexpr FormulaParameter kRoughness{.name = "roughness", .start = 0.2, .least = 1e-3, .most = 1.0};
constexpr FormulaParameter kWind{.name = "wind_m_per_s", .start = 7.0, .least = 0.0, .most = 30.0};

constexpr std::array kLambertian{FormulaParameter{.name = "rho", .start = 0.5, .least = 0.0, .most = 1.0}};
constexpr std::array kMinnaert{FormulaParameter{.name = "rho", .start = 0.5, .least = 0.0, .most = 2.0},
                               FormulaParameter{.name = "k", .start = 0.2, .least = -0.9, .most = 5.0}};
constexpr std::array kHapke{kOmega0};
constexpr std::array kHapkeHg{kOmega0, kAsymmetry};
constexpr std::array kRpv{FormulaParameter{.name = "rho0", .start = 0.2, .least = 0.0, .most = 1.0},
                          FormulaParameter{.name = "k", .start = 0.9, .least = 0.0, .most = 2.0}, kAsymmetry};
constexpr std::array kSea{kWind, kWaterIndex};
constexpr std::array kSlopes{FormulaParameter{.name = "slope_variance", .start = 0.04, .least = 1e-6, .most = 1.0},
                             kIndex};
constexpr std::array kFacets{kRoughness, kIndex};
constexpr std::array kWaterBody{FormulaParameter{.name = "rho_w", .start = 0.02, .least = 0.0, .most = 1.0},
                                kWaterIndex};

constexpr std::array kFormulas{
    FitFormula{"lambertian", kLambertian, lambertian},
    FitFormula{"minnaert", kMinnaert, minnaert},
    FitFormula{"hapke", kHapke, hapke},
    FitFormula{"hapke_as_printed", kHapke, hapke_as_printed},
    FitFormula{"hapke_hg", kHapkeHg, hapke},
    FitFormula{"rpv", kRpv, rpv},
    FitFormula{"rpv_brf", kRpv, rpv_brf},
    FitFormula{"cox_munk", kSea, cox_munk},
    FitFormula{"cox_munk_smith", kSea, cox_munk_smith},
    FitFormula{"glint_smith", kSlopes, glint_smith, true},
    FitFormula{"beckmann", kFacets, beckmann, true},
    FitFormula{"ggx", kFacets, ggx, true},
    FitFormula{"water_body", kWaterBody, water_body},
};

}  // namespace

std::span<const FitFormula> fit_formulas() {
  return kFormulas;
}

const FitFormula* find_formula(std::string_view model) {
  const auto found = std::ranges::find(kFormulas, model, &FitFormula::model);
  return found == kFormulas.end() ? nullptr : &*found;
}

}  // namespace gonio::fit
