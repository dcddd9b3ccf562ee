#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "reflectance/surface/surface.h"

namespace gonio::analysis {

/// A surface as people write it: a model of `make_surface` and its numbers, or a sum of such with weights.
///   rpv rho0=0.133 k=0.851 g=-0.114
///   lambertian rho=0.1 + 0.5 * ggx roughness=0.2 refractive_index=1.5
/// Errors: InvalidInput naming the word; those of make_surface and SurfaceSum.
[[nodiscard]] Result<reflectance::Surface> surface_of_text(std::string_view text);

/// The same the other way, to eight digits; of surfaces without numbers the model's name alone.
[[nodiscard]] std::string text_of_surface(const reflectance::Surface& surface);

}  // namespace gonio::analysis
