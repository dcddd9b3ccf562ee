#pragma once

#include <string>

#include "base/result.h"
#include "reflectance/surface/surface.h"

namespace gonio::fit {

/// The [sample] of a simulator's scene that holds this surface, every digit kept: one model, or a sum as
/// [[sample.terms]]. Errors: InvalidInput for a surface that has no model of `make_surface` (a table, an interpolated
/// scan): those are written as a file of readings, and the scene names it.
[[nodiscard]] Result<std::string> scene_sample(const reflectance::Surface& surface);

}  // namespace gonio::fit
