#pragma once

#include <string>
#include <string_view>

#include "reflectance/formats/export_files.h"
#include "reflectance/formats/measured_brdf.h"
#include "reflectance/formats/surface_file.h"

namespace gonio::formats {

struct RglOptions {
  std::size_t nodes = 64;           ///< along each side of the square of half vectors, 2 to 512
  double incidence_step_deg = 2.0;  ///< readers are linear between incidences: 10 deg cost 0.9 % of a Minnaert surface
};

/// The RGL material database's ".bsdf" (Dupuy and Jakob 2018; Mitsuba, pbrt), isotropic: f_r mu_r over a square of half
/// vectors, theta_m = (pi/2) u^2, phi_m - phi_i = (2 v - 1) pi, for each incidence up to 88 deg. The distribution of
/// normals is written as even (ndf = 4, sigma = 1, vndf = 1), so that values are read as they are; renderers sample it
/// poorly near theta_m = 0. All channels in one file, by wavelength; those without one are left out unless there is but
/// one. Losses: Channels, Wavelength, Anisotropy, Sign, Resampled, Extrapolated, Precision (floats), and what `file`
/// had lost. Errors: InvalidInput (no channel, an option out of its range).
[[nodiscard]] Result<Export> write_rgl(const SurfaceFile& file, const RglOptions& options = {});

/// Any file of the database: isotropic or not, spectra or rgb. Points are the nodes of its tables, through the warp of
/// its visible normals; those below the horizon and within 1 deg of it (f mu_r is what the file holds) are left out.
/// Errors: InvalidInput with the byte or the field: a field that is absent or of another shape, a value that is not
/// finite, more than kMostPoints.
[[nodiscard]] Result<MeasuredBrdf> read_rgl(std::string_view bytes, const std::string& file);

}  // namespace gonio::formats
