#pragma once

#include <iosfwd>
#include <string>

#include "base/result.h"
#include "sim/scene/scene.h"

namespace gonio::sim {

/// Writes the sample's true BRDF at each row of a CSV, in its order: point, theta_i_deg, phi_i_deg, theta_r_deg,
/// phi_r_deg, wavelength_nm, brdf_per_sr. The text has a header row that names at least theta_i_deg, theta_r_deg and
/// phi_r_deg; other columns are skipped, lines that begin with # too. Without phi_i_deg it is 0, without `point` rows
/// count from 0. `file` is for errors. Errors: InvalidInput, MissingKey, with line and column; nothing has been written
/// then.
[[nodiscard]] Result<std::string> truth_table(const Scene& scene, std::istream& csv, const std::string& file);

}  // namespace gonio::sim
