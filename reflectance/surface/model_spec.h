#pragma once

#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "base/result.h"

namespace gonio::reflectance {

/// One parameter of a model: finite, both ends of the range allowed. `unit` is empty where there is none.
struct ParameterSpec {
  std::string_view name;
  double least = -std::numeric_limits<double>::max();
  double most = std::numeric_limits<double>::max();
  std::string_view unit{};
  std::string_view meaning{};
};

/// A kind of surface with the name that files know it by. A choice, such as that of a norm, is a model name of its own.
struct ModelSpec {
  std::string_view name;
  std::string_view meaning;
  std::span<const ParameterSpec> parameters;
};

/// "0 to 1 m/s", for messages.
[[nodiscard]] std::string range_text(const ParameterSpec& spec);

/// Whether each value (in the order of the spec, as many) is finite and within its range.
/// Errors: InvalidInput, with model, parameter, value and range; `where.field` is the parameter.
[[nodiscard]] Result<void> check_values(const ModelSpec& model, std::span<const double> values);

}  // namespace gonio::reflectance
