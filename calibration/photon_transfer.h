#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "base/units.h"

namespace gonio::calibration {

/// What two frames of the same light tell of their noise: fixed patterns fall out of their difference.
struct FramePair {
  double mean_dn = 0.0;       ///< of both
  double variance_dn2 = 0.0;  ///< temporal, of one pixel of one frame
  std::uint32_t n = 0;        ///< pixels
};

/// EMVA 1288 release 4.0, eqs 18 and 19: the mean of both frames, and half the variance of their difference.
/// Errors: IncompleteData (frames of unlike size, or fewer than two pixels).
[[nodiscard]] Result<FramePair> pair_of(std::span<const std::uint16_t> first, std::span<const std::uint16_t> second);

/// A detector's photon transfer, as estimated; standard uncertainties from the scatter that n pixels allow a variance.
struct PhotonTransfer {
  Measured<double> electrons_per_dn;
  Measured<double> read_noise_dn;  ///< with the dark current's shot noise of the dark pair's exposure
};

/// Fits  variance = read^2 + (mean - dark mean) / K  (EMVA 1288 release 4.0, eq 5) to pairs at several levels of light
/// by weighted least squares; the weight of a pair follows from its own fitted variance, 2 variance^2 / n. `dark` is a
/// pair without light. Errors: IncompleteData (no lit pair at a level above the dark), OutOfLimits (a variance that
/// does not grow with the light).
[[nodiscard]] Result<PhotonTransfer> photon_transfer(const FramePair& dark, const std::vector<FramePair>& lit);

}  // namespace gonio::calibration
