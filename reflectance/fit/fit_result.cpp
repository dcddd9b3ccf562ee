#include "reflectance/fit/fit_result.h"

#include <algorithm>

namespace gonio::fit {

const FittedParameter* FitResult::find(std::string_view name) const {
  const auto at = std::ranges::find(parameters, name, &FittedParameter::name);
  return at == parameters.end() ? nullptr : &*at;
}

bool FitResult::fits() const {
  constexpr double kLeast = 1e-3;
  return p_value >= kLeast;
}

std::vector<std::string> FitResult::undetermined() const {
  std::vector<std::string> names;
  for (const FittedParameter& p : parameters) {
    if (!p.is_determined) names.push_back(p.name);
  }
  return names;
}

}  // namespace gonio::fit
