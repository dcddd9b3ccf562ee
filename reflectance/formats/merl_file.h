#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "reflectance/formats/export_files.h"
#include "reflectance/formats/measured_brdf.h"
#include "reflectance/formats/surface_file.h"

namespace gonio::formats {

/// The binary tables of Matusik et al. (2003): isotropic, half and difference angles of Rusinkiewicz, nodes at
/// theta_h = n^2/90 deg (n = 0..89), theta_d and phi_d every degree (0..89, 0..179), three planes of doubles for red,
/// green and blue. File: ".binary", 34 992 012 bytes. One channel fills all three planes; of more than three the ones
/// nearest to 610, 550 and 465 nm are taken, in order of that. Losses: Wavelength, Channels, Anisotropy, Sign,
/// Resampled, Extrapolated, and what `file` had lost. Takes 0.75e6 evaluations a channel. Errors: InvalidInput (no
/// channel).
[[nodiscard]] Result<Export> write_merl(const SurfaceFile& file);

struct MerlOptions {
  std::size_t step = 1;      ///< every step-th node along each angle: 1 gives some 0.7e6 points a channel
  bool all_channels = true;  ///< else green alone
};

/// Channels R, G, B; nodes below the horizon are left out. Errors: InvalidInput with the byte: other dimensions,
/// another length than they make, a value that is no number, a step of 0.
[[nodiscard]] Result<MeasuredBrdf> read_merl(std::string_view bytes, const std::string& file,
                                             const MerlOptions& options = {});

}  // namespace gonio::formats
