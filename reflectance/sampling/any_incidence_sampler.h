#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/result.h"
#include "reflectance/sampling/direction_sample.h"
#include "reflectance/sampling/random_stream.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

struct RowOptions {
  std::size_t most_rows = 129;  ///< 9 to 513; some 60 kB each
  double most_ratio = 2.0;      ///< of a weight to their mean, half-way between two rows; above 1
};

/// An isotropic surface for light from anywhere: a table of theta_r and phi_r (TableSampler) for each of a row of
/// theta_i. One of the two rows about theta_i is chosen, nearer ones more often, and the weight is f mu_r by the
/// density of that choice as a whole: unbiased at any theta_i, whatever the rows are off by, one evaluation of the BRDF
/// a draw. The mirror part is drawn with its own share. Below 0.02 deg of elevation the lowest row serves alone.
/// Immutable; threads: any.
class AnyIncidenceSampler {
 public:
  /// Rows are put between two as long as half-way a weight is met that is more than `most_ratio` times their mean.
  /// Errors: InvalidInput: an option out of its range, an anisotropic surface, rows that do not suffice (a lobe much
  /// narrower than their distance: make_sampler for each incidence, or FacetSampler), and those of TableSampler::make.
  [[nodiscard]] static Result<AnyIncidenceSampler> make(const Surface& surface, const RowOptions& options = {});

  /// Draw `index` of the stream for light from `i`. The mean of the weights is rho_dh(i), mirror part included.
  [[nodiscard]] DirectionSample sample(const Direction& i, const RandomStream& stream, std::uint64_t index) const;

  [[nodiscard]] std::size_t rows() const { return rows_.size(); }
  /// The largest weight over their mean that was met half-way between rows, in 512 draws each: tried, not proven.
  [[nodiscard]] double met_ratio() const { return met_ratio_; }

 private:
  struct Row;
  struct Place {
    std::size_t low = 0;  ///< index of the lower of two rows
    double part = 0.0;    ///< from there to the next, 0 to 1
  };

  AnyIncidenceSampler(const Surface& surface, const RowOptions& options) : surface_(surface), options_(options) {}
  [[nodiscard]] Result<void> add_row(double v);
  [[nodiscard]] Result<void> close_gaps();
  [[nodiscard]] double worst_ratio(double v) const;
  [[nodiscard]] Place place(double v) const;

  Surface surface_;
  RowOptions options_;
  std::vector<std::shared_ptr<const Row>> rows_;  ///< ascending in v
  double met_ratio_ = 1.0;
};

}  // namespace gonio::reflectance
