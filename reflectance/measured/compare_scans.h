#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/result.h"
#include "reflectance/check/symmetry_groups.h"
#include "reflectance/measured/measured_scan.h"
#include "reflectance/surface/surface.h"
#include "reflectance/table/tabulated_surface.h"

namespace gonio::reflectance {

struct CompareOptions {
  Angle tolerance = degrees(0.05);  ///< of arc, for each direction; 0 to 5 deg
  /// When two geometries are one: for isotropic samples a turn about the normal, or a mirror image, changes nothing.
  Sameness sameness = Sameness::Exact;
};

/// Two values of one geometry.
struct PointGap {
  std::size_t first = 0;   ///< index of the point in the first scan
  std::size_t second = 0;  ///< in the second; the same as `first` beside a surface or a table
  Geometry geometry;       ///< of the first
  Brdf difference;         ///< first - second
  Brdf u;                  ///< k = 1, of what does not cancel
  Brdf u_interpolation;    ///< what of u is doubt between the readings of a table; 0 beside others
  double z = 0.0;          ///< difference / u
};

struct ScanComparison {
  std::vector<PointGap> gaps;
  double chi2 = 0.0;  ///< of all gaps together, with the correlations between them
  std::size_t degrees_of_freedom = 0;
  double p_value = 1.0;             ///< the probability of a larger chi2 if both are the same
  std::size_t unpaired_first = 0;   ///< usable points without a partner
  std::size_t unpaired_second = 0;  ///< likewise
  /// Why points of the first have no partner beside a table: how many lie where of its readings.
  struct OutsideTable {
    std::size_t beyond_incidences = 0;
    std::size_t beyond_views = 0;
    std::size_t in_holes = 0;
  };
  OutsideTable outside;
  double mean_ratio = 0.0;  ///< sum of first / sum of second, over the pairs; 0 where the second is 0

  /// The gap of the largest |z|; null without any.
  [[nodiscard]] const PointGap* worst() const;
};

/// Point by point in units of what does not cancel: random parts of both, and the difference of the effects of each
/// component that they share (equal `source`); components of one scan alone count in full. Points without a partner
/// within the tolerance are counted, never interpolated. Errors: as `check` of either scan; InvalidInput: a u_random
/// that is 0, no common geometry, a tolerance out of range, more than 2048 components that do not cancel.
[[nodiscard]] Result<ScanComparison> compare_scans(const MeasuredScan& first, const MeasuredScan& second,
                                                   const CompareOptions& options = {});

/// A scan beside a surface that is taken to be exact, be it a formula, another scan's fit or its interpolant: all
/// components of the scan count. Errors: likewise; a value of the surface that is not finite.
[[nodiscard]] Result<ScanComparison> compare_with_surface(const MeasuredScan& scan, const Surface& surface);

/// What a table is taken for between its readings.
enum class BetweenReadings : std::uint8_t {
  Uncertain,  ///< as good as its readings tell: interpolation_uncertainty counts, as each point's own
  Exact,      ///< what was measured, as where it stood on the stage itself
};

/// A scan beside another instrument's readings, read between them as `table` does, which was made of the usable points
/// of `readings`, in their order, without reciprocal mixing. Their uncertainties count by the table's weights, what
/// both share (equal `source`) cancels. Points that the table does not cover are counted as `unpaired_first` and by
/// where they lie. Errors: likewise; InvalidInput where it covers none. `readings` may be without uncertainties.
[[nodiscard]] Result<ScanComparison> compare_with_table(const MeasuredScan& scan, const TabulatedSurface& table,
                                                        const MeasuredScan& readings, BetweenReadings between);

}  // namespace gonio::reflectance
