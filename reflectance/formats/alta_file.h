#pragma once

#include <string>
#include <string_view>

#include "reflectance/formats/measured_brdf.h"

namespace gonio::formats {

/// Text of the ALTA library: `#` lines for a header, then rows of input and output columns between blanks. Inputs, in
/// radians: SPHERICAL_TL_PL_TV_PV, ISOTROPIC_TV_TL_DPHI, ISOTROPIC_TL_TV_PROJ_DPHI, RUSIN_TH_TD_PD, RUSIN_TH_PH_TD_PD,
/// CARTESIAN. Outputs: INV_STERADIAN, INV_STERADIAN_COSINE_FACTOR (divided by cos(theta_r); rows within 1 deg of the
/// horizon have no digits for that and are left out, and a remark counts them), RGB_COLOR. A vertical segment (#VS 1 or
/// 2) becomes U, without k: ALTA does not say one. Errors: InvalidInput with the line: an absent or other
/// parameterisation, a number of columns that it does not have, no finite number, a direction below the horizon.
[[nodiscard]] Result<MeasuredBrdf> read_alta(std::string_view text, const std::string& file);

}  // namespace gonio::formats
