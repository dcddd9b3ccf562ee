#pragma once

#include "reflectance/formats/export_files.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::formats {

/// Text of the pab goniophotometers, what Radiance's `pabopto2bsdf` makes its interpolants of: a file for each
/// incidence and channel ("-30-0.dat", theta_i and phi_i rounded to 0.01 deg; "-550nm-30-0.dat"), lines of theta, phi
/// [deg] and BSDF [sr^-1]. Incidences closer than 0.01 deg are one, at the first one's angles. Directions are ours,
/// "up" is phi = 0. Losses: as `losses_of_bare_values`, and Metadata. Errors: as `check`; InvalidInput for more than
/// 1000 incidences.
[[nodiscard]] Result<Export> write_pab(const MeasuredBrdf& brdf);

}  // namespace gonio::formats
