#include "sim/scene/truth.h"

#include <algorithm>
#include <numbers>

#include "sim/scene/chance.h"

namespace gonio::sim {
namespace {

using stage::Axis;

void fold_side(Angle& theta, Angle& phi) {
  if (theta.si() >= 0.0) return;
  theta = -theta;
  phi += degrees(180.0);
}

bool is_arm(Axis axis) {
  return axis == Axis::ThetaI || axis == Axis::ThetaR || axis == Axis::PhiR || axis == Axis::PhiI;
}

}  // namespace

Geometry folded(Geometry g) {
  fold_side(g.theta_i, g.phi_i);
  fold_side(g.theta_r, g.phi_r);
  return g;
}

Measured<double> certificate_at(const ReferenceSpec& reference, Wavelength wavelength) {
  const auto& entries = reference.certificate;
  const auto above = std::ranges::lower_bound(entries, wavelength, {}, &CertificateEntry::wavelength);
  if (above == entries.end())
    return {entries.back().reflectance, entries.back().uncertainty / reference.coverage_factor};
  if (above == entries.begin()) return {above->reflectance, above->uncertainty / reference.coverage_factor};
  const auto below = std::prev(above);
  const double t = (wavelength - below->wavelength) / (above->wavelength - below->wavelength);
  return {std::lerp(below->reflectance, above->reflectance, t),
          std::lerp(below->uncertainty, above->uncertainty, t) / reference.coverage_factor};
}

Truth::Truth(const Scene& scene)
    : seed_(scene.seed),
      sample_(scene.sample),
      reference_(scene.reference),
      amplitudes_(scene.reference.modes.size(), 0.0),
      u_repeat_(scene.angles.u_repeat),
      u_placing_(scene.lamp.u_reproducibility),
      draws_errors_(scene.draws_errors) {
  if (scene.effects.stop) {
    stop_radius_ = scene.effects.stop->radius.value;
    stop_distance_ = scene.effects.stop->distance.value;
  }
  if (!scene.draws_errors) return;
  const auto normal = [&](Purpose purpose, std::uint64_t counter) { return Chance(seed_, purpose, counter).normal(); };
  const auto zero = [&](Axis axis, Angle u) {
    zero_errors_[stage::index_of(axis)] = u * normal(Purpose::ZeroError, stage::index_of(axis));
  };
  zero(Axis::ThetaI, scene.angles.u_zero_theta_i);
  zero(Axis::ThetaR, scene.angles.u_zero_theta_r);
  zero(Axis::PhiR, scene.angles.u_zero_phi_r);
  nonlinearity_ = scene.detector.u_linearity * normal(Purpose::Linearity, 0);
  certificate_error_ = normal(Purpose::Certificate, 0);
  if (scene.effects.stop) {
    stop_radius_ += scene.effects.stop->radius.u * normal(Purpose::Stop, 0);
    stop_distance_ += scene.effects.stop->distance.u * normal(Purpose::Stop, 1);
  }
  for (std::size_t k = 0; k < amplitudes_.size(); ++k) {
    amplitudes_[k] = reference_.modes[k].u * normal(Purpose::ShapeMode, k);
  }
  // The certificate fixes the integral, so the modes may not change it; what is left of it has its own uncertainty.
  const auto drawn_shape = [&](const Geometry& g) { return shape_(g) * mode_factor(g, reference_.modes, amplitudes_); };
  const double integral = amplitudes_.empty() ? 1.0 : integral_at_8_degrees(drawn_shape);
  shape_scale_ = (1.0 + reference_.u_integral * normal(Purpose::Certificate, 1)) / integral;
}

Brdf Truth::sample(const Geometry& g) const {
  const Geometry directions = folded(g);
  Brdf sum;
  for (const auto& term : sample_) sum += term.weight * term.surface.eval(directions);
  return sum;
}

Brdf Truth::reference(const Geometry& g, Wavelength wavelength) const {
  const Geometry directions = folded(g);
  const Measured<double> certificate = certificate_at(reference_, wavelength);
  const double rho = certificate.value + certificate.u * certificate_error_;
  const double shape = shape_scale_ * shape_(directions) * mode_factor(directions, reference_.modes, amplitudes_);
  return per_steradian(rho * shape / std::numbers::pi);
}

Angle Truth::repeat_error(Axis axis, std::uint64_t move) const {
  if (!is_arm(axis) || u_repeat_.si() == 0.0) return {};
  return u_repeat_ * Chance(seed_, Purpose::RepeatError, move * stage::kAxisCount + stage::index_of(axis)).normal();
}

double Truth::placing(std::uint64_t move) const {
  if (u_placing_ == 0.0) return 1.0;
  return 1.0 + u_placing_ * Chance(seed_, Purpose::Placing, move).normal();
}

double Truth::attenuation(const FilterSpec& filter) const {
  if (!filter.attenuation) return 1.0;
  const double error =
      draws_errors_ ? Chance(seed_, Purpose::Attenuator, static_cast<std::uint64_t>(filter.slot)).normal() : 0.0;
  return filter.attenuation->value + filter.attenuation->u * error;
}

}  // namespace gonio::sim
