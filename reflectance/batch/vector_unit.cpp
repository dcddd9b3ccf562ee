#include "reflectance/batch/vector_unit.h"

namespace gonio::reflectance {
namespace {

VectorUnit found() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool has_avx512 =
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  if (has_avx512) return VectorUnit::Avx512;
  if (__builtin_cpu_supports("avx2")) return VectorUnit::Avx2;
#endif
  return VectorUnit::Baseline;
}

}  // namespace

VectorUnit vector_unit() {
  static const VectorUnit unit = found();
  return unit;
}

}  // namespace gonio::reflectance
