#pragma once

#include "reflectance/formats/export_files.h"
#include "reflectance/formats/surface_file.h"

namespace gonio::formats {

/// The window programs' XML (LBNL WINDOW, Radiance, EnergyPlus) in the full Klems basis: 145 patches of incidence by
/// 145 of reflection, each value the mean BRDF of a pair of patches, by 2 x 2 directions of each. "Reflection Back",
/// which is what Radiance takes for a front. The basis for incidence is the other one's turned by 180 deg, so that a
/// mirror is on the diagonal. A file a channel (".xml"). Losses: Sign, Resampled, Extrapolated, Precision (patches are
/// 10 deg wide), Metadata, and what `file` had lost. 3e5 evaluations a channel. Errors: InvalidInput (no channel).
[[nodiscard]] Result<Export> write_klems(const SurfaceFile& file);

}  // namespace gonio::formats
