#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "reflectance/direction/direction.h"
#include "reflectance/sampling/direction_sample.h"
#include "reflectance/sampling/random_stream.h"
#include "reflectance/sampling/sample_batch.h"

namespace gonio::reflectance {

/// How a sampler draws.
enum class SamplingMethod : std::uint8_t {
  Closed,         ///< by the model's own inverse
  VisibleFacets,  ///< by the facet that mirrors the light
  Sum,            ///< one of the terms, each by its own method
  Table,          ///< from a tabulated density, the weight making good what the table is off by
  FastTable,      ///< from a tabulated density, all weights alike
};

/// What is known of a sampler since it was made. The mean of the weights is `rho_dh` in every method.
struct SamplerReport {
  SamplingMethod method = SamplingMethod::Closed;
  double rho_dh = 0.0;        ///< of the surface for this incidence, mirror part included
  double rho_dh_error = 0.0;  ///< by which `rho_dh` may be off
  /// No weight is larger in size. Exact for a closed form and for facets; of a table the largest met at 24 points of
  /// each cell, its distance from the mean doubled: tried, not proven.
  double most_weight = 0.0;
  /// Half the integral of |density drawn from - density wanted|: no set of directions is drawn with a probability
  /// farther off. 0 in all methods but FastTable, which are exact in the mean.
  double total_variation = 0.0;
  double relative_rms = 0.0;  ///< of density wanted / drawn from - 1 over the draws: the spread of a Table's weights
  std::size_t cells = 0;
  std::uint64_t evaluations = 0;  ///< of the BRDF, to make the sampler

  /// Whether the light gains energy, so that the weight of a photon grows without end (Rpv as a BRDF beyond 89.5 deg,
  /// an unshadowed glint). Nothing is clipped: the caller decides.
  [[nodiscard]] bool gains_energy() const { return rho_dh > 1.0; }
};

/// Draws directions as light from one direction leaves one surface (Mobley 2005, appendix C). Draw k of a stream is the
/// same, bit for bit, however the draws are split into batches and threads. Immutable; threads: any.
class DirectionSampler {
 public:
  virtual ~DirectionSampler() = default;
  DirectionSampler(const DirectionSampler&) = delete;
  DirectionSampler& operator=(const DirectionSampler&) = delete;

  /// Draws first, first + 1, ... of the stream, as many as `out` holds.
  void sample(const RandomStream& stream, std::uint64_t first, const SampleBatch& out) const;
  /// Draw `index` alone: the same direction but for the last bits of its angles. One at a time costs some 100 ns more.
  [[nodiscard]] DirectionSample sample(const RandomStream& stream, std::uint64_t index) const;

  [[nodiscard]] const Direction& incidence() const { return i_; }
  [[nodiscard]] virtual const SamplerReport& report() const = 0;

  /// Draws are made in runs of at most this many.
  static constexpr std::size_t kRun = 256;
  /// One run: out[n] becomes draw indices[n]. `out` is as long as `indices`, at most kRun (asserted).
  void draw(const RandomStream& stream, std::span<const std::uint64_t> indices, const SampleBatch& out) const;

 protected:
  explicit DirectionSampler(const Direction& i) : i_(i) {}

 private:
  virtual void draw_run(const RandomStream& stream, std::span<const std::uint64_t> indices,
                        const SampleBatch& out) const = 0;

  Direction i_;
};

}  // namespace gonio::reflectance
