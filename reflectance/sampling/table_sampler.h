#pragma once

#include <memory>

#include "base/result.h"
#include "reflectance/sampling/alias_table.h"
#include "reflectance/sampling/density_tree.h"
#include "reflectance/sampling/direction_sampler.h"
#include "reflectance/sampling/draw_kernels.h"
#include "reflectance/sampling/sampler_options.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// Any surface for one incidence, from a table of f mu_r: bilinear on rectangles of the hemisphere (hemisphere_chart.h)
/// that become smaller where the density bends, with the retro and the mirror direction at their corners; a corner is
/// chosen by an alias table, the place about it by two square roots. The mirror part is one more entry.
class TableSampler final : public DirectionSampler {
 public:
  /// Errors: InvalidInput: an option out of its range; a BRDF that is not finite, or is negative and not to be
  /// (`where.field` "surface"); an accuracy that is not reached (`where.field` "accuracy"), or an integral over the
  /// table that differs from rho_dh by more than that: there is a peak that no cell has met.
  [[nodiscard]] static Result<std::unique_ptr<const TableSampler>> make(const Surface& surface, const Direction& i,
                                                                        const SamplerOptions& options = {});

  [[nodiscard]] const SamplerReport& report() const override { return report_; }
  /// The probability per steradian with which r is drawn, mirror part aside.
  [[nodiscard]] double density_per_sr(const Direction& r) const;

 private:
  TableSampler(const Surface& surface, const Direction& i, DensityTree tree);
  void make_alias();
  void make_report(const SamplerOptions& options, const struct Integral& rho);
  [[nodiscard]] Result<void> check(const SamplerOptions& options, const struct Integral& rho) const;

  void draw_run(const RandomStream& stream, std::span<const std::uint64_t> indices,
                const SampleBatch& out) const override;
  [[nodiscard]] const DensityCell& cell_of(std::uint32_t entry) const;
  void choose_places(DrawBlock& block) const;
  void weigh(const DrawBlock& block, const SampleBatch& out) const;
  void put_mirrored(const DrawBlock& block, const SampleBatch& out) const;

  Surface surface_;
  DensityTree tree_;
  AliasTable alias_;
  double specular_ = 0.0;  ///< share of the light that is mirrored
  double total_ = 0.0;     ///< of the table and the mirror part
  SamplerReport report_;
};

}  // namespace gonio::reflectance
