#pragma once

#include "reflectance/sampling/direction_sampler.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// A surface whose model draws by an inverse in closed form.
class ClosedSampler final : public DirectionSampler {
 public:
  /// The surface must offer one (asserted).
  ClosedSampler(const Surface& surface, const Direction& i);

  [[nodiscard]] const SamplerReport& report() const override { return report_; }

 private:
  void draw_run(const RandomStream& stream, std::span<const std::uint64_t> indices,
                const SampleBatch& out) const override;

  Surface surface_;
  SamplerReport report_;
};

}  // namespace gonio::reflectance
