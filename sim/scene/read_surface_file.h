#pragma once

#include <string>

#include "base/result.h"
#include "reflectance/surface/surface.h"

namespace gonio::sim {

/// The surface of a file of BRDF values, in any format that is read: a table of its readings (a CSV's sidecar is the
/// .json beside it). `channel` names one of several, "550nm"; empty for the only one. Errors: FileUnreadable; as
/// formats::read_brdf and surfaces_of; InvalidInput, with the names there are, for a channel that the file does not
/// have.
[[nodiscard]] Result<reflectance::Surface> surface_of_file(const std::string& path, const std::string& channel);

}  // namespace gonio::sim
