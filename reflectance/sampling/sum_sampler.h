#pragma once

#include <memory>
#include <vector>

#include "reflectance/sampling/alias_table.h"
#include "reflectance/sampling/direction_sampler.h"

namespace gonio::reflectance {

/// A sum of surfaces: a term is chosen by its share of rho_dh, and draws in its own way. So all weights are rho_dh
/// where those of the terms are theirs.
class SumSampler final : public DirectionSampler {
 public:
  struct Term {
    double weight = 1.0;  ///< of the surface in the sum
    std::shared_ptr<const DirectionSampler> sampler;
  };

  /// At least one term, all for one incidence (asserted); a term whose rho_dh is not above 0 is never chosen.
  explicit SumSampler(std::vector<Term> terms);

  [[nodiscard]] const SamplerReport& report() const override { return report_; }

 private:
  void draw_run(const RandomStream& stream, std::span<const std::uint64_t> indices,
                const SampleBatch& out) const override;
  void draw_term(std::size_t term, const RandomStream& stream, std::span<const std::uint64_t> indices,
                 std::span<const std::uint32_t> chosen, const SampleBatch& out) const;

  std::vector<Term> terms_;
  AliasTable alias_;
  std::vector<double> scales_;  ///< of the terms' weights: 1 over the probability of choice, times the term's weight
  SamplerReport report_;
};

}  // namespace gonio::reflectance
