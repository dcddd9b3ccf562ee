#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "reflectance/formats/export_files.h"
#include "reflectance/formats/measured_brdf.h"
#include "reflectance/formats/surface_file.h"

namespace gonio::formats {

/// The directions of a Zemax file, in degrees, each list rising. Azimuths and radials are about the mirror direction:
/// azimuth 0 from there towards the normal, counter-clockwise (reflectance/convention/specular_centred_angles.h).
struct ZemaxAxes {
  std::vector<double> incidences{0, 10, 20, 30, 40, 50, 60, 70, 80};
  std::vector<double> azimuths{};  ///< empty: every 10 deg, to 180 for an isotropic surface, else to 360
  std::vector<double> radials{0,  1,  2,  3,  4,  5,  6,  8,  10, 12, 15,  20,  25,  30,  35,  40,
                              45, 50, 55, 60, 65, 70, 75, 80, 85, 90, 100, 110, 120, 130, 140, 150};
};

/// Tabular BSDF text of OpticStudio ("BSDF data interchange", Radiant Imaging 2008): reflection, one channel a file
/// (".bsdf"), PlaneSymmetrical for an isotropic surface, else Asymmetrical; one sample rotation. Directions below the
/// horizon read 0. TIS is rho_dh of the surface. Losses: Sign, Resampled, Extrapolated, Anisotropy, and what `file` had
/// lost. Errors: InvalidInput (no channel, an axis that is empty, out of range or not rising).
[[nodiscard]] Result<Export> write_zemax(const SurfaceFile& file, const ZemaxAxes& axes = {});

/// One channel, or X, Y, Z. Directions below the horizon are left out, and zeros that fill a row up to its end (with a
/// remark: laboratories write them beyond their instrument's reach); the values at radial 0, one for each azimuth, are
/// one point. A sample rotation is -phi_i. Errors: InvalidInput with the line: a key that is absent or out of
/// order, a list of another length than it says, too few values, BTDF.
[[nodiscard]] Result<MeasuredBrdf> read_zemax(std::string_view text, const std::string& file);

}  // namespace gonio::formats
