#pragma once

#include <string>
#include <string_view>

#include "reflectance/formats/export_files.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::formats {

/// The "universal BRDF" JSON of the metrology institutes (BiRD and BxDiff projects; Lanevski et al. 2022), schema 1.0.
/// Written so that the published schema accepts it: BRDF and uBRDF at least 0, theta below 90 deg, angles in degrees.
/// The signed values stand in adhoc_variables too (`f_signed`), as do k, the shared part of u, flags and channel, so
/// that `read_bird` gives back what was written. Texts that the schema wants and nobody knows read "not stated".
/// File: ".brdf". Losses: Sign (for other readers), PointsDropped (a theta of 90 deg). Errors: as `check`, also when no
/// point is left.
[[nodiscard]] Result<Export> write_bird(const MeasuredBrdf& brdf);

/// Any file of the schema, degrees or radians, uBRDF in sr^-1 or percent. Its own rules are checked (lengths of all
/// arrays, ranges). Errors: InvalidInput, naming file and path in the JSON, or the line where it is none.
[[nodiscard]] Result<MeasuredBrdf> read_bird(std::string_view json, const std::string& file);

}  // namespace gonio::formats
