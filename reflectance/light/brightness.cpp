#include "reflectance/light/brightness.h"

#include <fmt/format.h>

namespace gonio::reflectance {

Result<void> check_brightness(std::string_view light, std::string_view field, double value) {
  if (is_brightness(value)) return {};
  return failure({.code = ErrorCode::InvalidInput,
                  .tried = fmt::format("make a {}", light),
                  .seen = fmt::format("{} = {}", field, value),
                  .limit = "finite, at least 0",
                  .where = InputLocation{.file = {}, .field = std::string(field)}});
}

}  // namespace gonio::reflectance
