#pragma once

#include "reflectance/formats/loss.h"
#include "reflectance/formats/measured_brdf.h"

namespace gonio::formats {

/// What a format without error bars, flags, polarisation or many words leaves out of this BRDF: what it does not have
/// is not lost.
[[nodiscard]] Losses losses_of_bare_values(const MeasuredBrdf& brdf);

/// "" for the only channel, "-550nm" for one of several: part of a file's name, of letters, digits, '.', '_' and '-'.
[[nodiscard]] std::string channel_suffix(const MeasuredBrdf& brdf, std::size_t channel);

}  // namespace gonio::formats
