#pragma once

#include <map>
#include <string>

#include "base/toml_reader.h"
#include "protocol/api/plan.h"

namespace gonio::api {

/// Reads [geometry] and its parts. Errors are recorded in the reader; that of a list of points, which is a file of its
/// own, in `listed`.
void read_geometry(TomlReader geometry, const std::map<std::string, std::string>& files, Plan& plan,
                   Result<void>& listed);

}  // namespace gonio::api
