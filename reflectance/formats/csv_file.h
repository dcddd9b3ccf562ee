#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "reflectance/formats/export_files.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::formats {

/// Our own format: a CSV with a row of names, and a JSON beside it. Loses nothing: what is read back compares equal, to
/// the bit. Files: ".csv" and ".json". Columns:
///   theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg, f_per_sr             needed
///   channel, wavelength_nm, U_per_sr, k, u_shared_per_sr, flags          flags by name, with '|' between
/// Errors: as `check`; InvalidInput for a flag's name with a comma or '|' in it.
[[nodiscard]] Result<Export> write_csv(const MeasuredBrdf& brdf);

/// Columns in any order, with our names or those that csv_names.h takes for them; between them commas, semicolons or
/// tabs (then a comma may be the decimal point), cells in quotation marks or not. Blank lines, and lines that begin
/// with '#', are passed over. Without a sidecar a channel is what has a number of its own in the column `channel`, or a
/// wavelength; each flag's name is taken as it comes; nothing is known of the sample, and its symmetry is
/// `symmetry_of`. Errors: InvalidInput with line and column: no such column, one without its unit, a missing one, too
/// few or too many cells, no finite number, a last line without its end, another number of points than the sidecar
/// says.
[[nodiscard]] Result<MeasuredBrdf> read_csv(std::string_view csv, std::optional<std::string_view> sidecar,
                                            const std::string& file);

}  // namespace gonio::formats
