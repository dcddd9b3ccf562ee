#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "reflectance/batch/direction_block.h"
#include "reflectance/batch/vector_unit.h"
#include "reflectance/sampling/random_stream.h"

namespace gonio::reflectance {

/// The draws of one block on their way from bits to directions, a row each: what a vector unit reads.
struct alignas(64) DrawBlock {
  static constexpr std::size_t kSize = DirectionBlock::kSize;
  template <class T>
  using Row = std::array<T, kSize>;

  Row<std::uint64_t> index;
  std::array<Row<std::uint32_t>, 4> bits;
  Row<std::uint32_t> entry;  ///< of the table: cell x 4 + corner, or the mirror part
  Row<double> v;             ///< place in the chart
  Row<double> w;
  Row<double> mu;
  Row<double> sin_theta;
  Row<double> x;
  Row<double> y;
};

/// bits[j][n] = stream.block(index[n])[j] for all lanes.
void fill_bits(const RandomStream& stream, DrawBlock& block, VectorUnit unit = vector_unit());

/// mu, sin(theta) and the unit vector's x and y at (v, w); (cosine, sine) is the direction of w = 0. The same bits
/// whatever the vector unit.
void fill_directions(double cosine, double sine, DrawBlock& block, VectorUnit unit = vector_unit());

}  // namespace gonio::reflectance
