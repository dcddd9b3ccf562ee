#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "reflectance/measured/guide.h"
#include "reflectance/measured/measured_scan.h"
#include "reflectance/surface/surface.h"
#include "reflectance/table/tabulated_surface.h"

namespace gonio::reflectance {

/// A scan as a surface: at a reading that reading, between readings (value by guide) interpolated linearly as
/// TabulatedSurface does it, times the guide. Beyond the readings' reach the ratio to the guide is held, so that the
/// value goes on as the guide does; `covers` says where that is. Linear in the readings, signs included. Immutable,
/// copies share the data; threads: any.
class ScanInterpolant {
 public:
  /// `options.symmetry` and `options.beyond` are overruled: the scan's own, and Hold. Readings in one plane are laid
  /// out as rings. Errors: as `check` of the scan; as TabulatedSurface::make; InvalidInput where the guide is not above
  /// 0 at a reading.
  [[nodiscard]] static Result<ScanInterpolant> make(const MeasuredScan& scan, const Guide& guide,
                                                    TableOptions options = {});

  [[nodiscard]] Brdf eval(const Direction& i, const Direction& r) const {
    return per_steradian(guide_at(i, r) * in_per_steradian(table_.eval(i, r)));
  }
  /// With the standard uncertainty of the readings there, as of one error: no less than the truth however they are
  /// correlated; without the error of the interpolation.
  [[nodiscard]] Measured<Brdf> measured(const Direction& i, const Direction& r) const;
  [[nodiscard]] bool covers(const Direction& i, const Direction& r) const { return table_.covers(i, r); }

  /// What the value at (i, r) is of the scan's points: value = sum of weight x value, by index of MeasuredScan::points,
  /// a point perhaps more than once. Appends; returns `covers`.
  bool shares(const Direction& i, const Direction& r, std::vector<ReadingShare>& shares) const;

  [[nodiscard]] std::string_view model() const { return "interpolated_scan"; }
  [[nodiscard]] Parameters parameters() const { return table_.parameters(); }
  [[nodiscard]] bool is_isotropic() const { return table_.is_isotropic() && guide_.surface.is_isotropic(); }
  /// The harder of the guide's and of what is left.
  [[nodiscard]] Feature feature() const { return std::max(guide_.surface.feature(), table_.feature()); }

  [[nodiscard]] const Guide& guide() const { return guide_; }
  /// Of value by guide.
  [[nodiscard]] const TabulatedSurface& table() const { return table_; }

  /// How far each reading is from what the others make of it, value in sr^-1: over all that have neighbours, views and
  /// incidences alike. An upper bound for the interpolation: the others lie twice as far apart.
  [[nodiscard]] std::vector<double> cross_validation_errors() const;

 private:
  ScanInterpolant(Guide guide, double floor, TabulatedSurface table, std::vector<std::uint32_t> point,
                  std::vector<double> per_guide);

  // A little above the guide itself, so that where it is next to nothing, readings count as they are.
  [[nodiscard]] double guide_at(const Direction& i, const Direction& r) const {
    return guide_.surface.eval(i, r).si() + floor_;
  }

  Guide guide_;
  double floor_;
  TabulatedSurface table_;
  std::shared_ptr<const std::vector<std::uint32_t>> point_;  ///< index in the scan of each of the table's readings
  std::shared_ptr<const std::vector<double>> per_guide_;     ///< 1 by the guide at each of them
};

}  // namespace gonio::reflectance
