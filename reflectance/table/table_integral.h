#pragma once

#include "reflectance/integral/integral.h"
#include "reflectance/table/tabulated_surface.h"

namespace gonio::reflectance {

/// rho_dh(i) of a table, by Gauss nodes within the cells of its readings, so that no kink lies inside of a panel: what
/// `rho_dh(Surface(table), i)` finds as well, which meets kinks everywhere and needs up to 1e6 evaluations for 1e-5.
/// Orders are raised until two agree to `relative_tolerance` >= 1e-13. `error` is the quadrature's alone: what the
/// interpolation and the part beyond the reach are worth, `cross_validate` and `extrapolated_share` tell. A reciprocal
/// table, and readings that do not surround the normal, have no such cells and go the general way.
[[nodiscard]] Integral rho_dh(const TabulatedSurface& table, const Direction& i, double relative_tolerance = 1e-6);

}  // namespace gonio::reflectance
