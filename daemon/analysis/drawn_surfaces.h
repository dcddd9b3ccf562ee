#pragma once

#include "base/result.h"
#include "reflectance/formats/measured_brdf.h"
#include "reflectance/formats/surface_file.h"

namespace gonio::analysis {

/// The surfaces that pictures show. Tables call cells wider than 25 deg a hole, and integrals model them; in a picture
/// a hole is what is wider than the scan's own cells are, so that a coarse grid is not white where its rows part.
/// Errors: as formats::surfaces_of.
[[nodiscard]] Result<formats::SurfaceFile> drawn_surfaces(const formats::MeasuredBrdf& brdf);

}  // namespace gonio::analysis
