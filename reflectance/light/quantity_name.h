#pragma once

#include <span>
#include <string_view>

#include "base/result.h"

namespace gonio::reflectance {

/// A reflectance as files and books name it.
struct QuantityName {
  std::string_view name;    ///< in files: "radf_normal_incidence"
  std::string_view symbol;  ///< in formulas: "RADF"
  std::string_view unit;    ///< "sr^-1", or "1" for a ratio
  std::string_view formula;
  std::string_view source;
  std::string_view why_not{};  ///< why this library does not give it; empty for what it gives
  [[nodiscard]] constexpr bool is_supported() const { return why_not.empty(); }
};

/// All that have a name, what is not supported last.
[[nodiscard]] std::span<const QuantityName> quantity_names();

/// The supported quantity of this name. Errors: InvalidInput, with the reason for a name that is known and not
/// supported, with all names for any other.
[[nodiscard]] Result<QuantityName> find_quantity(std::string_view name);

}  // namespace gonio::reflectance
