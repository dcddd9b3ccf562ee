#pragma once

#include <array>
#include <cstddef>

#include "calibration/instrument_model.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

inline constexpr std::size_t kLinearityTerms = 3;

/// The light behind a net signal N: N + sum a_k p_k with p_k = <n^(k+1)> / full_scale^k over the pixels of the region,
/// n = N + (pixel - mean): Lin^-1 acts on each pixel, and Lin^-1 of a mean is not the mean of Lin^-1. The means of
/// powers follow exactly from the region's central moments m2, m3, m4 (binomial theorem); k = 1 .. 3.
using LinearityPowers = std::array<double, kLinearityTerms>;

/// p_k of a camera's frame with this net mean, or of a radiometer, which has no pixels (`region` null).
[[nodiscard]] LinearityPowers linearity_powers(double net, double full_scale, const RegionMoments* region);

/// sum a_k p_k: what the correction adds to N.
[[nodiscard]] double linearity_gain(const LinearityModel& model, const LinearityPowers& powers);

}  // namespace gonio::calibration
