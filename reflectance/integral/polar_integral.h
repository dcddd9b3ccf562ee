#pragma once

#include "reflectance/integral/integral.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// integral of f(i, r) mu_r dOmega_r in polar coordinates about `axis`, where f has a kink or a peak: the retro
/// direction for a hot spot, the mirror direction for a lobe. There the kink is no more than an end of the range; the
/// horizon is the other end. A ladder of Gauss nodes is tried first (polar_ladder.h). Where it does not settle, the
/// double-exponential rule, which feels neither end: levels are raised until two of them agree to `relative_tolerance`
/// or the last level is reached (some 1e6 evaluations). About the normal itself, psi counts from the azimuth of `i`.
[[nodiscard]] Integral polar_integral(const Surface& surface, const Direction& i, const Direction& axis,
                                      double relative_tolerance);

}  // namespace gonio::reflectance
