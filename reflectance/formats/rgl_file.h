#pragma once

#include <string>
#include <string_view>

#include "reflectance/formats/export_files.h"
#include "reflectance/formats/measured_brdf.h"
#include "reflectance/formats/surface_file.h"

namespace gonio::formats {

struct RglOptions {
  /// Along each side of the square of half vectors, 2 to 512. Odd: the plane of incidence is a row of nodes. With 129
  /// the nearest node's view is within 1 deg of any in that plane, within 2.1 deg elsewhere (3 deg beyond theta_m = 45
  /// deg): a feature narrower than that needs more.
  std::size_t nodes = 129;
  /// Between incidences; the measured ones are nodes too, in place of steps closer than half of one. Readers are linear
  /// between incidences: 10 deg cost 0.9 % of a Minnaert surface.
  double incidence_step_deg = 2.0;
};

/// The RGL material database's ".bsdf" (Dupuy and Jakob 2018; Mitsuba, pbrt), isotropic: f_r mu_r over a square of half
/// vectors, theta_m = (pi/2) u^2, phi_m - phi_i = (2 v - 1) pi, for each incidence up to 88 deg. The distribution of
/// normals is written as even (ndf = 4, sigma = 1, vndf = 1), so that values are read as they are; renderers sample it
/// poorly near theta_m = 0. All channels in one file, by wavelength; those without one are left out unless there is but
/// one. Losses: Channels, Wavelength, Anisotropy, Sign, Resampled, Extrapolated, Precision (floats), and what `file`
/// had lost. Errors: InvalidInput (no channel, an option out of its range).
[[nodiscard]] Result<Export> write_rgl(const SurfaceFile& file, const RglOptions& options = {});

/// Any file of the database: isotropic or not, spectra or rgb. Points are the nodes of its tables, through the warp of
/// its visible normals; those below the horizon and within 1 deg of it (f mu_r is what the file holds) are left out. Of
/// a spectrum with more than `most_points` values every n-th wavelength is read; a remark says how many are left out.
/// Errors: InvalidInput with the byte or the field: a field that is absent or of another shape, a value that is not
/// finite, more than `most_points` of one wavelength.
[[nodiscard]] Result<MeasuredBrdf> read_rgl(std::string_view bytes, const std::string& file,
                                            std::size_t most_points = kMostPoints);

}  // namespace gonio::formats
