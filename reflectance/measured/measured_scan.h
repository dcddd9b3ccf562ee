#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "base/result.h"
#include "base/units.h"
#include "reflectance/check/symmetry_point.h"
#include "reflectance/table/table_options.h"

namespace gonio::reflectance {

/// A source of error that several points of a scan share.
struct ScanComponent {
  std::string name;    ///< "certificate", "zero theta_i"
  std::string source;  ///< what error it is, for other scans: equal texts are one error; empty: this scan's own
  /// Whether the effects on the points go together as they are stated. False for what bounds an error whose pattern
  /// nobody knows (slopes that the readings do not resolve): a fit must not take its course for known and subtract it.
  bool is_pattern_known = true;
};

/// One value of a scan.
struct MeasuredPoint {
  Geometry geometry;
  Brdf value;                        ///< signed
  Brdf u_random;                     ///< k = 1, of what this point shares with no other; 0 where none is known
  std::vector<SharedEffect> shared;  ///< by index of MeasuredScan::components
  bool is_flagged = false;           ///< not to be used; it keeps its place, so that indices stay those of the source
};

/// A measured scan at one wavelength, as data: what fits, integrals and comparisons take. Where it comes from
/// (a calibrated scan, a file) is the caller's.
struct MeasuredScan {
  std::string name;
  TableSymmetry symmetry = TableSymmetry::Isotropic;
  std::vector<ScanComponent> components;
  std::vector<MeasuredPoint> points;
};

/// Whether there is something to work with. Errors: InvalidInput, naming the scan and the point's index: no points,
/// all points flagged, a number that is not finite, a theta beyond 90 deg either way, a negative u_random, a component
/// that is not in the list. Flagged points are not looked at.
[[nodiscard]] Result<void> check(const MeasuredScan& scan);

/// The points that count, by index.
[[nodiscard]] std::vector<std::size_t> usable_points(const MeasuredScan& scan);

/// The combined standard uncertainty, k = 1.
[[nodiscard]] Brdf standard_u(const MeasuredPoint& point);

/// The scan with effects whose pattern is not known (`is_pattern_known`) counted as if each point had its own: they do
/// not cancel between points, nor with anything that does not share them.
[[nodiscard]] MeasuredScan with_unknown_as_random(MeasuredScan scan);

/// The scan's usable points for check/symmetry_check.h, effects of unknown pattern as random ones, and what the indices
/// there stand for.
struct ScanSymmetryPoints {
  std::vector<SymmetryPoint> points;
  std::vector<std::size_t> index;  ///< of MeasuredScan::points
};
[[nodiscard]] ScanSymmetryPoints symmetry_points(const MeasuredScan& scan);

}  // namespace gonio::reflectance
