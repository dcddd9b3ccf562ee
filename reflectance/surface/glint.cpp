#include "reflectance/surface/glint.h"

#include <array>
#include <numbers>

namespace gonio::reflectance {
namespace {

constexpr std::array kGlintParameters{
    ParameterSpec{.name = "slope_variance", .least = 1e-6, .most = 1.0, .meaning = "of both slope components together"},
    ParameterSpec{.name = "refractive_index", .least = 1.0, .most = 1e12, .meaning = "below over above the surface"},
};

}  // namespace

constinit const ModelSpec Glint::kSpec{"glint", "facets with Gaussian slopes, no shadowing", kGlintParameters};
constinit const ModelSpec Glint::kSpecSmith{"glint_smith", "facets with Gaussian slopes, Smith shadowing",
                                            kGlintParameters};

double cox_munk_slope_variance(double wind_m_per_s) {
  return (3.0 + 5.12 * wind_m_per_s) / 1000.0;
}

Glint::Glint(GlintParameters p)
    : p_(p), peak_(1.0 / (std::numbers::pi * p.slope_variance)), deviation_(std::sqrt(p.slope_variance)) {}

Result<Glint> Glint::make(GlintParameters p) {
  GONIO_TRY(check_values(spec(p.shadowing), std::array{p.slope_variance, p.refractive_index}));
  return Glint(p);
}

// Lambda = (exp(-v^2)/(v sqrt(pi)) - erfc(v)) / 2 with v = cot(theta)/sigma.
double Glint::hidden_ratio(const Direction& d) const {
  const double mu = clamped_mu(d);
  const double run = deviation_ * d.sin_theta();
  if (mu > 6.0 * run) return 0.0;  // below 4e-19: lost beside the 1 it is added to
  const double v = mu / run;
  return 0.5 * (std::exp(-v * v) / (v * std::sqrt(std::numbers::pi)) - std::erfc(v));
}

}  // namespace gonio::reflectance
