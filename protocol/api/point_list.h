#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "protocol/api/plan_part.h"

namespace gonio::api {

/// A list of points as comma-separated text: a line of names, then a point a line. theta_i_deg, theta_r_deg and
/// phi_r_deg must be there, in any order; phi_i_deg (0 when missing) and wavelength_nm may. Empty lines, and lines that
/// begin with '#', are passed over. Errors: InvalidInput, UnknownKey, MissingKey, each with file, line and field;
/// `file` is the user's name.
[[nodiscard]] Result<ListShape> parse_point_list(std::string_view csv, const std::string& file);

}  // namespace gonio::api
