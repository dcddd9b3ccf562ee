#pragma once

#include "reflectance/integral/integral.h"
#include "reflectance/light/light.h"
#include "reflectance/light/watch.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// E_d, E_u and the smooth part of L_r of one source alone, of weight 1, and one surface that is no sum. What `watch`
/// meets may make the result void: ask it.
[[nodiscard]] Integral irradiance_of(const LightSource& source, double relative_tolerance, Watch& watch);
[[nodiscard]] Integral sent_up(const Surface& leaf, const LightSource& source, double relative_tolerance, Watch& watch);
[[nodiscard]] Integral radiance_towards(const Direction& r, const Surface& leaf, const LightSource& source,
                                        double relative_tolerance, Watch& watch);

}  // namespace gonio::reflectance
