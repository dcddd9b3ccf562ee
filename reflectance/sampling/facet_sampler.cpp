#include "reflectance/sampling/facet_sampler.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/sampling/hemisphere_chart.h"

namespace gonio::reflectance {
namespace {

constexpr double kMostSlope = 6.5;  // over sigma: exp(-x^2) is 4e-19 there
constexpr double kRootPi = 1.7724538509055159;

}  // namespace

FacetSampler::FacetSampler(const Glint& glint, const Direction& i)
    : DirectionSampler(i),
      glint_(glint),
      deviation_(std::sqrt(glint.values().slope_variance)),
      level_(clamped_mu(i)),
      tilt_(deviation_ * i.sin_theta()),
      steepest_(level_ < kMostSlope * tilt_ ? level_ / tilt_ : kMostSlope),
      seen_(0.5 * kRootPi * level_ * (1.0 + std::erf(steepest_)) + 0.5 * tilt_ * std::exp(-steepest_ * steepest_)),
      hidden_i_(glint.hidden_ratio(i)) {
  const Integral rho = rho_dh(Surface(glint), i);
  report_ = {.method = SamplingMethod::VisibleFacets,
             .rho_dh = rho.value,
             .rho_dh_error = rho.error,
             .most_weight = glint.values().shadowing == Shadowing::Smith ? 1.0 : 1.0 + hidden_i_,
             .evaluations = rho.evaluations};
}

// Where the integral of (level + tilt x) exp(-x^2) from the steepest facet that is seen reaches the share u: Newton's
// steps, halvings where one would leave the bracket.
double FacetSampler::slope_along(double u) const {
  const double start = 0.5 * kRootPi * level_ * std::erf(steepest_) + 0.5 * tilt_ * std::exp(-steepest_ * steepest_);
  double low = -steepest_;
  double high = kMostSlope;
  double x = 0.0;
  for (int step = 0; step < 60; ++step) {
    const double bell = std::exp(-x * x);
    const double excess = start + 0.5 * kRootPi * level_ * std::erf(x) - 0.5 * tilt_ * bell - u * seen_;
    (excess > 0.0 ? high : low) = x;
    const double slope = (level_ + tilt_ * x) * bell;
    const double newton = x - excess / slope;
    const double next = newton > low && newton < high ? newton : 0.5 * (low + high);  // also where newton is NaN
    if (std::abs(next - x) < 1e-13) return next;
    x = next;
  }
  return x;
}

// In the frame whose x axis points to the light's azimuth; slopes over sigma.
Vector FacetSampler::mirrored_by(double along, double across, double& cos_omega) const {
  const double a = deviation_ * along;
  const double b = deviation_ * across;
  const double length2 = 1.0 + a * a + b * b;
  const double sin_i = incidence().sin_theta();
  const double facing = std::max(0.0, sin_i * a + incidence().mu());
  cos_omega = facing / std::sqrt(length2);
  const double scale = 2.0 * facing / length2;
  return {.x = scale * a - sin_i, .y = scale * b, .z = scale - incidence().mu()};
}

double FacetSampler::weight(const Vector& r, double cos_omega) const {
  if (r.z <= 0.0) return 0.0;
  const double c = std::min(1.0, cos_omega);
  const double mirrored = fresnel(c, std::sqrt((1.0 - c) * (1.0 + c)), glint_.values().refractive_index).unpolarised();
  if (glint_.values().shadowing == Shadowing::None) return mirrored * (1.0 + hidden_i_);
  return mirrored * (1.0 + hidden_i_) / (1.0 + hidden_i_ + glint_.hidden_ratio(Direction::from_vector(r)));
}

void FacetSampler::draw_run(const RandomStream& stream, std::span<const std::uint64_t> indices,
                            const SampleBatch& out) const {
  const double cosine = std::cos(incidence().phi().si());
  const double sine = std::sin(incidence().phi().si());
  for (std::size_t n = 0; n < indices.size(); ++n) {
    const RandomBlock bits = stream.block(indices[n]);
    const double along = slope_along(open_unit(bits[0], bits[1]));
    // Box and Muller (1958): the square of the radius is exponential.
    const double across = std::sqrt(-std::log(open_unit(bits[2]))) * turn_vector(open_unit(bits[3])).cosine;
    double cos_omega = 0.0;
    Vector r = mirrored_by(along, across, cos_omega);
    out.weight[n] = weight(r, cos_omega);
    if (r.z <= 0.0) {
      const double length = std::hypot(r.x, r.y);
      r = length > 0.0 ? Vector{.x = r.x / length, .y = r.y / length} : Vector{.x = 1.0};
    }
    out.x[n] = r.x * cosine - r.y * sine;
    out.y[n] = r.x * sine + r.y * cosine;
    out.z[n] = r.z;
    out.is_specular[n] = 0;
  }
}

}  // namespace gonio::reflectance
