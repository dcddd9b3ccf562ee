#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "reflectance/formats/measured_brdf.h"

namespace gonio::formats {

/// What stands beside our CSV: everything but the points, and by what to know that they belong together.
struct Sidecar {
  MeasuredBrdf brdf;  ///< without points
  std::size_t points = 0;
};

/// JSON, one object, keys as in BrdfMetadata; ends with a newline.
[[nodiscard]] std::string sidecar_json(const MeasuredBrdf& brdf);
/// Errors: InvalidInput, naming file and key; the line where it is no JSON.
[[nodiscard]] Result<Sidecar> read_sidecar_json(std::string_view text, const std::string& file);

}  // namespace gonio::formats
