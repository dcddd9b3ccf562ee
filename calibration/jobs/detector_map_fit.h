#pragma once

#include <optional>
#include <vector>

#include "base/result.h"
#include "calibration/aperture_mask.h"
#include "calibration/jobs/found_values.h"
#include "calibration/jobs/pixel_sums.h"
#include "calibration/map_file.h"

namespace gonio::calibration {

/// What is known of each pixel after a job, as the files that `[detector.maps]` reads. Beyond the aperture nothing was
/// measured: dark and flat are NaN there, which a reduction refuses, should the aperture be moved.
struct DetectorMapFit {
  MapFile dark;                 ///< offset [DN]; with two exposures or more also rate [DN/s]
  MapFile bad;                  ///< 0: good
  std::optional<MapFile> flat;  ///< response, its mean over the aperture's good pixels is 1
  /// "dark_offset_dn", "dark_rate_dn_per_s", "flat": means over good pixels, each with the u of one pixel's value;
  /// "dark_offset_spread_dn", "dark_rate_spread_dn_per_s", "flat_spread": standard deviations from pixel to pixel, by
  /// the median deviation; "light_uneven": the quarter of the aperture whose mean lies farthest from 1, how far;
  /// "bad_pixels" and, by cause, "bad_hot", "bad_noisy", "bad_dead", "bad_uneven" (one pixel may have several).
  FoundValues found;
};

/// Dark level of each pixel, offset + rate t, by weighted least squares over the exposures; u is that of the frames'
/// own scatter, times sqrt(chi-square / dof) where the levels of an exposure lie off the line by more than that (Birge,
/// 1932), what all pixels have in common aside. Bad are pixels whose offset or rate lies more than 6 standard
/// deviations of the map above its median (hot), or whose scatter does so, by the distribution of chi-square, and is
/// four times the median variance at least (noisy). `darks`: one for each exposure.
/// Errors: IncompleteData (none; an exposure read once only; stacks of different squares).
[[nodiscard]] Result<DetectorMapFit> fit_dark_map(const std::vector<PixelStack>& darks, const ApertureMask& mask);

/// The same, and the response to even light: sums of the lit frames less as many times the dark level of the same
/// exposure, pixel by pixel. Bad besides: less than half the median response (dead), or more than 6 standard deviations
/// of the map from it (uneven). Light that is not even is taken for response: "light_uneven" says what it may be.
/// Errors: those of fit_dark_map; IncompleteData (no exposure was lit twice in one reading, none of them has a dark,
/// no light).
[[nodiscard]] Result<DetectorMapFit> fit_flat_field(const std::vector<PixelStack>& darks,
                                                    const std::vector<PixelStack>& lit, const ApertureMask& mask);

}  // namespace gonio::calibration
