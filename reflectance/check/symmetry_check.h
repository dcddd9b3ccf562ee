#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/result.h"
#include "reflectance/check/symmetry_groups.h"
#include "reflectance/check/symmetry_point.h"

namespace gonio::reflectance {

/// Two points that should agree.
struct SymmetryGap {
  std::size_t first = 0;   ///< index of the point; in a group of more than two all are compared with its first
  std::size_t second = 0;  ///< index of the other
  Brdf difference;         ///< first - second
  Brdf u;                  ///< k = 1, of what does not cancel
  double z = 0.0;          ///< difference / u
};

struct SymmetryReport {
  std::vector<SymmetryGap> gaps;
  double chi2 = 0.0;  ///< of all gaps together, with the correlations between them
  std::size_t degrees_of_freedom = 0;
  double p_value = 1.0;  ///< the probability of a larger chi2 if the symmetry holds and the uncertainties are true
  std::size_t unpaired = 0;
  std::size_t trivial = 0;
  std::size_t repeated = 0;

  /// The gap of the largest |z|; null without any.
  [[nodiscard]] const SymmetryGap* worst() const;
};

/// How well the points keep a symmetry, z = (f - f') / u_diff for each pair and chi-square for all (README.md says how
/// shared components enter). Points without a partner are counted, never interpolated. Errors: InvalidInput, naming
/// the point: as for `find_symmetry_groups`; a value, u_random or effect that is not finite (or beyond 1e50 /sr);
/// u_random not above 0 (or below 1e-50 /sr); more than 2048 components that do not cancel.
[[nodiscard]] Result<SymmetryReport> check_symmetry(Symmetry symmetry, std::span<const SymmetryPoint> points,
                                                    const SymmetryOptions& options = {});

}  // namespace gonio::reflectance
