#include "reflectance/surface/ggx.h"

#include <array>

namespace gonio::reflectance {
constinit const ModelSpec Ggx::kSpec{"ggx", "facets with long-tailed slopes, Smith shadowing", kFacetParameters};

Result<Ggx> Ggx::make(GgxParameters p) {
  GONIO_TRY(check_values(kSpec, std::array{p.roughness, p.refractive_index}));
  return Ggx(p);
}

}  // namespace gonio::reflectance
