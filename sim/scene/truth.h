#pragma once

#include <cstdint>
#include <vector>

#include "base/geometry.h"
#include "base/units.h"
#include "protocol/stage/axis.h"
#include "sim/scene/scene.h"
#include "sim/scene/spectralon_shape.h"

namespace gonio::sim {

/// What is really so in one scene of one seed, and what no daemon is ever told: the surfaces, the arms' zeros, the
/// errors of the certificate. Every error is one draw from the uncertainty that the papers state. Immutable; threads:
/// any.
class Truth {
 public:
  explicit Truth(const Scene& scene);

  /// At the true directions; theta may be slightly negative (an arm beyond its zero), which is the other side of the
  /// pole.
  [[nodiscard]] Brdf sample(const Geometry& g) const;
  [[nodiscard]] Brdf reference(const Geometry& g, Wavelength wavelength) const;

  /// True angle = encoder's angle + this, for every reading of the seed. Zero for carriage, wheel and sample azimuth.
  [[nodiscard]] Angle zero_error(stage::Axis axis) const { return zero_errors_[stage::index_of(axis)]; }
  /// What the encoder of this axis does not see of its move number `move`. 0 for carriage and wheel.
  [[nodiscard]] Angle repeat_error(stage::Axis axis, std::uint64_t move) const;
  /// Factor of the signal from move number `move` to the next: placing, fine structure.
  [[nodiscard]] double placing(std::uint64_t move) const;
  /// net' = net (1 + this * net / full scale).
  [[nodiscard]] double nonlinearity() const { return nonlinearity_; }
  /// The detector's stop as it is; the scene must have one.
  [[nodiscard]] Length stop_radius() const { return stop_radius_; }
  [[nodiscard]] Length stop_distance() const { return stop_distance_; }
  /// The part of the light that what stands in this slot beside the filter passes; 1 without an attenuator.
  [[nodiscard]] double attenuation(const FilterSpec& filter) const;

 private:
  std::uint64_t seed_;
  std::vector<reflectance::SurfaceTerm> sample_;
  ReferenceSpec reference_;
  SpectralonShape shape_;
  std::vector<double> amplitudes_;
  double shape_scale_ = 1.0;
  double certificate_error_ = 0.0;  ///< in standard uncertainties
  stage::PerAxis<Angle> zero_errors_{};
  Angle u_repeat_;
  double u_placing_ = 0.0;
  double nonlinearity_ = 0.0;
  Length stop_radius_;
  Length stop_distance_;
  bool draws_errors_ = true;
};

/// Certificate and uncertainty at a wavelength, linear between entries, the nearest entry outside of them.
[[nodiscard]] Measured<double> certificate_at(const ReferenceSpec& reference, Wavelength wavelength);

/// The same directions with thetas >= 0 and azimuths turned where a theta was negative.
[[nodiscard]] Geometry folded(Geometry g);

}  // namespace gonio::sim
