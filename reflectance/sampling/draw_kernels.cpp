#include "reflectance/sampling/draw_kernels.h"

#include "reflectance/batch/lane_loop.h"
#include "reflectance/sampling/hemisphere_chart.h"

namespace gonio::reflectance {

void fill_bits(const RandomStream& stream, DrawBlock& block, VectorUnit unit) {
  const std::uint64_t* const index = block.index.data();
  std::uint32_t* const __restrict b0 = block.bits[0].data();
  std::uint32_t* const __restrict b1 = block.bits[1].data();
  std::uint32_t* const __restrict b2 = block.bits[2].data();
  std::uint32_t* const __restrict b3 = block.bits[3].data();
  const RandomStream local = stream;
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    const RandomBlock bits = local.block(index[k]);
    b0[k] = bits[0];
    b1[k] = bits[1];
    b2[k] = bits[2];
    b3[k] = bits[3];
  });
}

void fill_directions(double cosine, double sine, DrawBlock& block, VectorUnit unit) {
  const double* const v = block.v.data();
  const double* const w = block.w.data();
  double* const __restrict mu = block.mu.data();
  double* const __restrict sin_theta = block.sin_theta.data();
  double* const __restrict x = block.x.data();
  double* const __restrict y = block.y.data();
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    const ChartRing ring = chart_ring(v[k]);
    const TurnVector turn = turn_vector(w[k]);
    mu[k] = ring.mu;
    sin_theta[k] = ring.sin_theta;
    x[k] = ring.sin_theta * (turn.cosine * cosine - turn.sine * sine);
    y[k] = ring.sin_theta * (turn.cosine * sine + turn.sine * cosine);
  });
}

}  // namespace gonio::reflectance
