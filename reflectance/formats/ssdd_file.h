#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "reflectance/formats/export_files.h"
#include "reflectance/formats/measured_brdf.h"
#include "reflectance/formats/surface_file.h"

namespace gonio::formats {

/// The directions of an SSDD file in spherical coordinates [deg], each list rising. phi_i has one entry unless the
/// surface changes with it; phi_r counts from phi_i then.
struct SsddAxes {
  std::vector<double> theta_i{0, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 75, 80, 85};
  std::vector<double> phi_i{0};
  std::vector<double> theta_r{0, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 75, 80, 85, 90};
  std::vector<double> phi_r{};  ///< empty: every 5 deg, 0 to 360, to 180 for an isotropic surface
};

/// Surface scattering distribution data 0.2 (libbsdf's documentation): text, spherical coordinates, ".ssdd". Channels
/// become a spectrum where all have a wavelength, else each has a file. Losses: Resampled, Extrapolated, and what
/// `file` had lost; signs are kept. Errors: InvalidInput (no channel, an axis that is empty, out of range or not
/// rising).
[[nodiscard]] Result<Export> write_ssdd(const SurfaceFile& file, const SsddAxes& axes = {});

/// The axes of points that are a full grid (at the pole one azimuth is enough), so that `write_ssdd` reads each value
/// at its own direction; else the ones above.
[[nodiscard]] SsddAxes ssdd_axes_of(const MeasuredBrdf& brdf);

/// The file's BRDF block; spherical, specular or half-difference coordinates, values as text or in binary, any colour
/// model. Directions below the horizon are left out, and blocks after it (a remark says so). Errors: InvalidInput with
/// line or byte: an order, key or word that is not the format's, lists that do not rise, too few values, in text too
/// many, a block that is no BRDF.
[[nodiscard]] Result<MeasuredBrdf> read_ssdd(std::string_view bytes, const std::string& file);

}  // namespace gonio::formats
