#pragma once

#include <limits>

#include "reflectance/sampling/literal_sampler.h"
#include "reflectance/sampling/table_sampler.h"
#include "reflectance/surface/surface.h"

namespace gonio::bench {

/// How far what a sampler draws is from the BRDF. NaN where it does not apply.
struct DensityError {
  double rho = std::numeric_limits<double>::quiet_NaN();        ///< of the mean weight, relative
  double misplaced = std::numeric_limits<double>::quiet_NaN();  ///< total variation: the share of draws that go astray
  double weight_sd = std::numeric_limits<double>::quiet_NaN();  ///< of a draw's weight, relative to the mean
};

/// By quadrature over directions that no sampler has seen; `rho_dh` is the surface's.
[[nodiscard]] DensityError table_error(const reflectance::Surface& s, const reflectance::Direction& i,
                                       const reflectance::TableSampler& table, double rho_dh);
/// f taken for constant in each cell, at its middle.
[[nodiscard]] DensityError literal_error(const reflectance::Surface& s, const reflectance::Direction& i,
                                         reflectance::LiteralCells cells, double rho_dh);
/// Directions by the cosine law with weight pi f.
[[nodiscard]] DensityError cosine_error(const reflectance::Surface& s, const reflectance::Direction& i, double rho_dh);

/// The greatest f [1/sr] on a fine grid, widened by a hundredth: what rejection needs to know.
[[nodiscard]] double greatest_brdf(const reflectance::Surface& s, const reflectance::Direction& i);

}  // namespace gonio::bench
