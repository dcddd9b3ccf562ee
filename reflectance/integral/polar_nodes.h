#pragma once

#include <array>
#include <cstddef>

#include "reflectance/batch/direction_block.h"
#include "reflectance/batch/vector_unit.h"

namespace gonio::reflectance {

/// 64 places in polar coordinates about an axis: the arc xi from it in the azimuth psi about it, psi = 0 towards the
/// normal. As Meridian, side by side.
struct alignas(64) PolarNodes {
  using Row = DirectionBlock::Row;
  Row xi{};    ///< [rad], 0 to pi
  Row left{};  ///< the arc that is left to the horizon, given apart: mu keeps its digits there
  Row rise{};  ///< of the meridian: mu = rise sin(left)
  Row cos_psi{};
  Row sin_psi{};
};

/// The directions of all places, to some 1e-16 absolute, mu relative; and `share` = mu sin(xi), by which an integrand
/// is multiplied. `origin` is the azimuth that psi = 0 points away from; that of the axis, or any when it is the
/// normal.
void place(DirectionBlock& directions, DirectionBlock::Row& share, const PolarNodes& nodes, const Direction& axis,
           Angle origin, VectorUnit unit = vector_unit());

}  // namespace gonio::reflectance
