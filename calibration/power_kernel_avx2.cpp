// Built with this instruction set (CMakeLists.txt), called where the processor has it.
#include "calibration/power_kernel.h"

#if defined(__AVX2__)
#include <immintrin.h>

#include "calibration/power_kernel_vectors.h"

namespace gonio::calibration {
namespace {

struct Avx2 {
  using Words [[gnu::vector_size(32)]] = std::uint16_t;
  using Sums [[gnu::vector_size(32)]] = std::uint32_t;

  [[gnu::always_inline]] static __m256i plain(Words words) { return reinterpret_cast<__m256i>(words); }
  [[gnu::always_inline]] static Words mulhrs(Words a, Words b) {
    return reinterpret_cast<Words>(_mm256_mulhrs_epi16(plain(a), plain(b)));
  }
  [[gnu::always_inline]] static Sums madd(Words a, Words b) {
    return reinterpret_cast<Sums>(_mm256_madd_epi16(plain(a), plain(b)));
  }
  [[gnu::always_inline]] static Sums add_madd(Sums to, Words a, Words b) { return to + madd(a, b); }
  [[gnu::always_inline]] static Words count_less(Words counts, Words a, Words b) {
    return counts - reinterpret_cast<Words>(_mm256_cmpgt_epi16(plain(b), plain(a)));
  }
};

}  // namespace

void add_powers_avx2(PixelRows rows, PixelRows soon, std::uint16_t full_scale, PowerSums& sums) {
  VectorSummer<Avx2>(full_scale).add(rows, soon, sums);
}

}  // namespace gonio::calibration
#endif
