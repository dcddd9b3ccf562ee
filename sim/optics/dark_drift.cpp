#include "sim/optics/dark_drift.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gonio::sim {
namespace {

constexpr double kHour = 3600.0;

}  // namespace

DarkDrift::DarkDrift(const Scene& scene) : rest_(scene.environment.detector), spec_(scene.effects.dark_drift) {
  if (!spec_) return;
  if (spec_->wander != 0.0) rate_wander_.emplace(scene.seed, Purpose::DarkWander, spec_->correlation_s);
  if (spec_->offset_wander_dn != 0.0) offset_wander_.emplace(scene.seed, Purpose::OffsetWander, spec_->correlation_s);
}

Temperature DarkDrift::detector_temperature(double scene_s) const {
  if (!spec_ || spec_->temperature_swing_k == 0.0) return rest_;
  const double turn = 2.0 * std::numbers::pi * scene_s / spec_->temperature_period_s;
  return rest_ + Temperature::from_si(spec_->temperature_swing_k * std::sin(turn));
}

double DarkDrift::rate_factor(double scene_s) const {
  if (!spec_) return 1.0;
  const double wander = rate_wander_ ? rate_wander_->at(scene_s, spec_->wander) : 0.0;
  const double warmth = (detector_temperature(scene_s) - rest_).si() / spec_->doubling_k;
  return std::max(0.0, (1.0 + spec_->per_hour * scene_s / kHour) * (1.0 + wander)) * std::exp2(warmth);
}

double DarkDrift::offset_shift_dn(double scene_s) const {
  if (!spec_) return 0.0;
  const double wander = offset_wander_ ? offset_wander_->at(scene_s, spec_->offset_wander_dn) : 0.0;
  return spec_->offset_dn_per_hour * scene_s / kHour + wander;
}

}  // namespace gonio::sim
