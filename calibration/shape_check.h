#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/geometry.h"
#include "base/result.h"
#include "base/units.h"
#include "calibration/reference_standard.h"

namespace gonio::calibration {

/// What a table is worth beside its own uncertainty, u (k = 1) of its modes; the rule stands at check_shape.
enum class ShapeVerdict : std::uint8_t { Sound, Doubtful, Contradicts };
/// "sound", "doubtful", "contradicts itself".
[[nodiscard]] std::string_view verdict_name(ShapeVerdict verdict);

/// Two nodes of a table, i and r exchanged, which any real surface would give the same value (Mobley 2005, eq 4).
struct ReciprocityPair {
  Wavelength wavelength;
  Geometry forth;    ///< phi_r is the table's dphi; `back` has the thetas exchanged
  double gap = 0.0;  ///< relative: 2 (s(forth) - s(back)) / (s(forth) + s(back))
  double u = 0.0;    ///< relative, k = 1: what the modes allow each of the two to be wrong by
};

/// What the table and the certificate together send back into the hemisphere.
struct HemisphereShare {
  Wavelength wavelength;
  Angle theta;
  bool is_of_incidence = true;  ///< light at theta, else the view at theta in light from everywhere
  double reflectance = 0.0;     ///< rho_cert (1/pi) integral s mu dOmega
  double u = 0.0;               ///< k = 1: certificate, modes, u of the integral
};

struct ShapeReport {
  ShapeVerdict verdict = ShapeVerdict::Sound;
  std::optional<ReciprocityPair> worst_pair;  ///< none: no node has its exchanged one in the table
  std::optional<HemisphereShare> brightest;   ///< most beyond 1 (or nearest to it) in its own u
  double largest_gap = 0.0;                   ///< of all pairs, relative, >= 0
  double as_written =
      1.0;  ///< what the file's own scale gives in the certificate's geometry: of the table farthest from 1
  std::vector<std::string> findings;  ///< sentences; first what decides the verdict
};

/// Reciprocity and energy of a standard's table, by its own nodes: nothing is interpolated but in wavelength.
///
/// Reciprocity: of two exchanged nodes one is wrong by at least half their gap. Half a gap within u of the modes at
/// that geometry (0.1 % added in quadrature: the digits of a printed table) is sound, within 2 u doubtful, beyond it
/// the table contradicts the uncertainty that it states. Energy: what the reflectance of any theta is above 1, at each
/// entry of the certificate, is doubtful beyond u, and a contradiction where it is beyond both 2 u and 5 %. The
/// integrals are exact for the interpolated table (hat functions against sin theta cos theta); beyond its last theta
/// the edge holds. Some ms for 25 x 25 x 25 nodes. Threads: any.
[[nodiscard]] ShapeReport check_shape(const ReferenceStandard& standard);

/// Errors: InvalidInput at the table, with the worst pair or the excess, when the report says `Contradicts`.
[[nodiscard]] Result<void> demand_consistency(const ReferenceStandard& standard, const ShapeReport& report);

}  // namespace gonio::calibration
