#pragma once

#include <cstddef>

#include "reflectance/batch/direction_block.h"
#include "reflectance/batch/vector_unit.h"

namespace gonio::reflectance {

#if defined(__x86_64__)

#if defined(__clang__)
#define GONIO_AVX512 "avx512f,avx512dq,avx512vl"
#else
#define GONIO_AVX512 "avx512f,avx512dq,avx512vl,prefer-vector-width=512"
#endif

template <class Body>
[[gnu::target("avx2")]] void for_each_lane_avx2(const Body& body) {
  const Body local = body;  // its captures in registers
  for (std::size_t k = 0; k < DirectionBlock::kSize; ++k) local(k);
}

template <class Body>
[[gnu::target(GONIO_AVX512)]] void for_each_lane_avx512(const Body& body) {
  const Body local = body;
  for (std::size_t k = 0; k < DirectionBlock::kSize; ++k) local(k);
}

#undef GONIO_AVX512

#endif

/// body(k) for each lane of a block, as compiled for `unit`, which the processor must have: the bits do not depend on
/// it. `body` is a lambda that is always inlined, [=](std::size_t k) GONIO_INLINED { ... }, free of branches and calls
/// other than those of vector_math.h. Only for sources that CMakeLists.txt lists as kernels.
template <class Body>
void for_each_lane(VectorUnit unit, const Body& body) {
#if defined(__x86_64__)
  if (unit == VectorUnit::Avx512) return for_each_lane_avx512(body);
  if (unit == VectorUnit::Avx2) return for_each_lane_avx2(body);
#endif
  static_cast<void>(unit);
  const Body local = body;
  for (std::size_t k = 0; k < DirectionBlock::kSize; ++k) local(k);
}

}  // namespace gonio::reflectance

#define GONIO_INLINED __attribute__((always_inline))
