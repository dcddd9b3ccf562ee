#pragma once

namespace gonio::reflectance {

/// A row of less weight than this says nothing of whether a place was measured: encoders end a thousandth of a step
/// beside an incidence.
inline constexpr double kLeastWeight = 1e-3;

}  // namespace gonio::reflectance
