#pragma once

#include <memory>

#include "base/result.h"
#include "reflectance/sampling/direction_sampler.h"
#include "reflectance/sampling/sampler_options.h"
#include "reflectance/surface/surface.h"

namespace gonio::reflectance {

/// What draws directions as light from `i` leaves `surface`: its model's own inverse where it has one, the
/// terms of a sum each in its own way, else a table (TableSampler), to which `options` apply. Errors: InvalidInput, as
/// TableSampler::make.
[[nodiscard]] Result<std::unique_ptr<const DirectionSampler>> make_sampler(const Surface& surface, const Direction& i,
                                                                           const SamplerOptions& options = {});

}  // namespace gonio::reflectance
