#pragma once

#include "reflectance/integral/integral.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// rho_dh(i), the directional-hemispherical reflectance: the share of the light from i that the surface sends back,
/// mirror part included (Nicodemus 1977; Mobley 2005, section 4). Closed where the surface has a formula; else by
/// quadrature: the model's own, or one chosen by its feature, in polar coordinates about retro-reflection for a hot
/// spot, about the mirror direction for a lobe, about the normal else; a sum term by term. Never clipped: a value above
/// 1 is the model's own and means that it breaks energy there. Asks for `relative_tolerance` >= 1e-14; see Integral for
/// what comes back. The models hold mu at 1e-12 or more (clamped_cosine.h); where f mu is finite at the horizon that is
/// up to 1e-12 of the value, which `error` does not know.
[[nodiscard]] Integral rho_dh(const Surface& surface, const Direction& i, double relative_tolerance = 1e-9);
/// At phi_i = 0. theta_i in [0, 90 deg] (asserted).
[[nodiscard]] Integral rho_dh(const Surface& surface, Angle theta_i, double relative_tolerance = 1e-9);

/// rho_hd(r), the hemispherical-directional reflectance: pi times the radiance towards r under light from all
/// directions alike, by the irradiance. Equal to rho_dh(r) for a reciprocal surface (Nicodemus 1977), and integrated
/// over i all the same, so that it also holds for one that is not. Method, tolerance and result as for rho_dh.
[[nodiscard]] Integral rho_hd(const Surface& surface, const Direction& r, double relative_tolerance = 1e-9);

/// A, the spherical or Bond albedo, also rho_hh: the share that is sent back of light from all directions alike,
/// (1/pi) integral of rho_dh(i) mu_i dOmega_i (Mobley 2005, section 4). Not clipped. Each rho_dh is found as closely as
/// its direction counts; `error` includes theirs.
[[nodiscard]] Integral bond_albedo(const Surface& surface, double relative_tolerance = 1e-6);

}  // namespace gonio::reflectance
