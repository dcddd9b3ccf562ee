#pragma once

#include <string>
#include <string_view>

#include "reflectance/formats/export_files.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::formats {

/// Text in the manner of ASTM E1392, as Cornell's data and their readers have it: `KEY value` lines, `VARS` with the
/// columns' names, then a line a direction: theta_i, phi_i, theta_s, phi_s in radians, and a value in sr^-1 for each
/// channel. Directions are ours. One file a channel (".astm", or "-550nm.astm" where there are several), since a scan
/// need not have all of them at each direction. Losses: Uncertainty, Flags, SharedPart, Polarisation; and other
/// programs' readers take a negative value for 0. Errors: as `check`.
[[nodiscard]] Result<Export> write_astm(const MeasuredBrdf& brdf);

/// Channels by the columns' names: "550nm" has a wavelength, "R" has none. Lines of the header that the format does not
/// know become remarks. Errors: InvalidInput with line and column: no VARS, fewer than five columns, cells that are too
/// many, too few or no finite numbers, another number of points than NUM_POINTS says.
[[nodiscard]] Result<MeasuredBrdf> read_astm(std::string_view text, const std::string& file);

}  // namespace gonio::formats
