#include "reflectance/surface/model_spec.h"

#include <cassert>
#include <cmath>

#include <fmt/format.h>

namespace gonio::reflectance {

std::string range_text(const ParameterSpec& spec) {
  const std::string unit = spec.unit.empty() ? "" : " " + std::string(spec.unit);
  return fmt::format("{} to {}{}", spec.least, spec.most, unit);
}

Result<void> check_values(const ModelSpec& model, std::span<const double> values) {
  assert(values.size() == model.parameters.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    const ParameterSpec& spec = model.parameters[k];
    if (values[k] >= spec.least && values[k] <= spec.most) continue;  // never for NaN
    return failure({.code = ErrorCode::InvalidInput,
                    .tried = fmt::format("make a surface \"{}\"", model.name),
                    .seen = fmt::format("{} = {}", spec.name, values[k]),
                    .limit = range_text(spec),
                    .where = InputLocation{.file = {}, .field = std::string(spec.name)}});
  }
  return {};
}

}  // namespace gonio::reflectance
