#pragma once

#include "reflectance/hemisphere_integral.h"
#include "reflectance/surface.h"

namespace gonio::reflectance {

/// rho_dh(i), the directional-hemispherical reflectance: the share of the light from i that the surface sends back,
/// mirror part included (Nicodemus 1977; Mobley 2005, section 4). Closed where the surface has a formula; else by
/// quadrature: Gauss rings, polar coordinates about retro-reflection for a hot spot, rings about the mirror direction
/// for a lobe; a sum term by term. Never clipped: a value above 1 is the model's own and means that it breaks energy
/// there. Asks for `relative_tolerance` >= 1e-14; see Integral for what comes back.
[[nodiscard]] Integral rho_dh(const Surface& surface, const Direction& i, double relative_tolerance = 1e-9);
/// At phi_i = 0. theta_i in [0, 90 deg] (asserted).
[[nodiscard]] Integral rho_dh(const Surface& surface, Angle theta_i, double relative_tolerance = 1e-9);

}  // namespace gonio::reflectance
