#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "calibration/reference_standard.h"

namespace gonio::calibration {

/// A part of a reference/*.toml, and where each of its lines comes from.
struct TomlPart {
  std::string text;                      ///< whole lines
  std::vector<InputLocation> came_from;  ///< of each line; no field: that of the TOML
};

/// [standard] and [certificate] from a lab's CSV (README.md): `# key: value` for all that is not a column, then
/// wavelength_nm, reflectance (or reflectance_percent), uncertainty (or uncertainty_percent). What the numbers mean is
/// checked when the TOML is read.
/// Errors, with file, line and field: InvalidInput, UnknownKey, MissingKey.
[[nodiscard]] Result<TomlPart> certificate_from_csv(std::string_view csv, const std::string& file);

/// [shape] from a lab's CSV: theta_i_deg, theta_r_deg, phi_deg, factor and, for several wavelengths, wavelength_nm; a
/// row for each node of the grid in any order, one for all phi where a theta is 0. `# u_integral: ...` and
/// `# mode: NAME KIND U [WIDTH_DEG]`. Errors: as above; InvalidInput for a node that is missing or stands there twice.
[[nodiscard]] Result<TomlPart> shape_from_csv(std::string_view csv, const std::string& file);

/// [shape] of a standard that is there, as TOML; `with_integral`: with its u_integral, which a 0/45 certificate has
/// not.
[[nodiscard]] TomlPart shape_of(const ReferenceStandard& standard, bool with_integral);

}  // namespace gonio::calibration
