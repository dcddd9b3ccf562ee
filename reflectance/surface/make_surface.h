#pragma once

#include <span>
#include <string_view>

#include "base/result.h"
#include "reflectance/surface/model_spec.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// Every model, in the order of the room's README.
[[nodiscard]] std::span<const ModelSpec> surface_models();

/// The surface of this model with these parameters, in any order:
///   make_surface("rpv", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}}).
/// Errors, each naming model and parameter (`where.field` is the parameter, or "model"): InvalidInput (no such model, a
/// parameter given twice, a value that is not finite or outside its range), UnknownKey, MissingKey.
[[nodiscard]] Result<Surface> make_surface(std::string_view model, const Parameters& parameters);

}  // namespace gonio::reflectance
