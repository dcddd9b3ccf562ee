#pragma once

#include <limits>
#include <span>
#include <string_view>

#include "base/result.h"
#include "reflectance/surface.h"

namespace gonio::reflectance {

/// One parameter of a model: both ends of the range are allowed. `unit` is empty where there is none.
struct ParameterSpec {
  std::string_view name;
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  std::string_view unit{};
  std::string_view meaning{};
};

/// A model that `make_surface` knows. A choice such as that of a norm or a form is a model name of its own.
struct ModelSpec {
  std::string_view name;
  std::string_view meaning;
  std::span<const ParameterSpec> parameters;
};

/// Every model, in the order of the room's README.
[[nodiscard]] std::span<const ModelSpec> surface_models();

/// The surface of this model with these parameters, in any order:
///   make_surface("rpv", {{"rho0", 0.133}, {"k", 0.851}, {"g", -0.114}}).
/// Errors, each naming model and parameter (`where.field` is the parameter, or "model"): InvalidInput (no such model, a
/// parameter given twice, a value that is not finite or outside its range), UnknownKey, MissingKey.
[[nodiscard]] Result<Surface> make_surface(std::string_view model, const Parameters& parameters);

}  // namespace gonio::reflectance
