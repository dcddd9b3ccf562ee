#pragma once

#include "reflectance/integral/integral.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// integral of f(i, r) mu_r dOmega_r in polar coordinates about `axis`, where f has a kink or a peak: the retro
/// direction for a hot spot, the mirror direction for a lobe. There the kink is no more than an end of the range, which
/// the double-exponential rule does not feel; the horizon is the other end. Levels are raised until two of them agree
/// to `relative_tolerance` or the last level is reached (some 1e6 evaluations).
[[nodiscard]] Integral polar_integral(const Surface& surface, const Direction& i, const Direction& axis,
                                      double relative_tolerance);

}  // namespace gonio::reflectance
