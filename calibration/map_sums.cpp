// Plain loops for the compiler to vectorise (this file is built with -O3 whatever the build, see CMakeLists.txt), once
// for any x86-64 and once for AVX2. Each of 16 lanes sums its own pixels, so that the order of the sums is written here
// and not chosen by the compiler: both give the same bits.
#include "calibration/map_sums.h"

#include <algorithm>
#include <array>

#include "calibration/vector_clones.h"

namespace gonio::calibration {
namespace {

constexpr std::size_t kLanes = 16;
constexpr std::size_t kBlock = 256;  // a lane then holds 16 values: its rounding stays near that of a single one
using Lanes = std::array<float, kLanes>;

struct BlockLanes {
  Lanes value{};
  Lanes value2{};
  Lanes light{};
};

template <bool is_curved>
GONIO_INLINE void add_pixel(const MappedRow& row, std::size_t k, float exposure_s, std::size_t lane, BlockLanes& to) {
  const float above = static_cast<float>(row.pixels[k]) - row.offset[k];
  const float net = above - row.rate[k] * exposure_s;
  float straight = net;
  if constexpr (is_curved) straight = net + net * net * (row.curve_1[k] + row.curve_2[k] * net);
  const float value = straight * row.weight[k];
  to.value[lane] += value;
  to.value2[lane] += value * value;
  to.light[lane] += above * (row.weight[k] * row.weight[k]);
}

GONIO_INLINE double sum(const Lanes& lanes) {
  double total = 0.0;
  for (const float lane : lanes) total += lane;
  return total;
}

template <bool is_curved>
GONIO_INLINE void add_row(const MappedRow& row, float exposure_s, MapSums& sums) {
  for (std::size_t from = 0; from < row.n; from += kBlock) {
    const std::size_t end = std::min(from + kBlock, row.n);
    BlockLanes lanes;
    std::size_t k = from;
    for (; k + kLanes <= end; k += kLanes) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) add_pixel<is_curved>(row, k + lane, exposure_s, lane, lanes);
    }
    for (std::size_t lane = 0; k < end; ++k, ++lane) add_pixel<is_curved>(row, k, exposure_s, lane, lanes);
    sums.value += sum(lanes.value);
    sums.value2 += sum(lanes.value2);
    sums.light += sum(lanes.light);
  }
}

GONIO_CLONE(add_straight, add_row<false>, (const MappedRow& row, float exposure_s, MapSums& sums),
            (row, exposure_s, sums))
GONIO_CLONE(add_curved, add_row<true>, (const MappedRow& row, float exposure_s, MapSums& sums), (row, exposure_s, sums))

}  // namespace

void add_mapped(const MappedRow& row, float exposure_s, MapSums& sums) {
  if (row.curve_1 == nullptr)
    add_straight(row, exposure_s, sums);
  else
    add_curved(row, exposure_s, sums);
}

}  // namespace gonio::calibration
