#pragma once

#include "reflectance/sampling/direction_sampler.h"
#include "reflectance/surface/glint.h"

namespace gonio::reflectance {

/// A glint by its facets: one is drawn from those that face the light, weighed by how much of them it sees, and mirrors
/// it (Heitz and d'Eon 2014: the visible normals; the slope along the light by inverting its distribution, the one
/// across it is Gaussian). The weight is R_F (1 + Lambda_i), with Smith's shadowing over 1 + Lambda_i + Lambda_r: at
/// most 1 + Lambda_i or 1, for any slope variance. Light that a facet sends below the horizon is lost, as in the model:
/// its weight is 0 and its direction in the horizon. Slopes beyond 6.7 standard deviations are not drawn.
class FacetSampler final : public DirectionSampler {
 public:
  FacetSampler(const Glint& glint, const Direction& i);

  [[nodiscard]] const SamplerReport& report() const override { return report_; }

 private:
  void draw_run(const RandomStream& stream, std::span<const std::uint64_t> indices,
                const SampleBatch& out) const override;
  [[nodiscard]] double slope_along(double u) const;
  [[nodiscard]] Vector mirrored_by(double along, double across, double& cos_omega) const;
  [[nodiscard]] double weight(const Vector& r, double cos_omega) const;

  Glint glint_;
  double deviation_;  ///< sigma of the slopes
  double level_;      ///< cos(theta_i), clear of 0
  double tilt_;       ///< sigma sin(theta_i)
  double steepest_;   ///< slope away from the light at which a facet is seen edge on, over sigma; at most kMostSlope
  double seen_;       ///< integral of (level + tilt x) exp(-x^2) over the facets that are seen
  double hidden_i_;   ///< Lambda_i
  SamplerReport report_;
};

}  // namespace gonio::reflectance
