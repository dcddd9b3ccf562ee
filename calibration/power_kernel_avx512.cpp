// Built with this instruction set (CMakeLists.txt), called where the processor has it.
#include "calibration/power_kernel.h"

#if defined(__AVX512VNNI__)
#include <immintrin.h>

#include "calibration/power_kernel_vectors.h"

namespace gonio::calibration {
namespace {

struct Avx512 {
  using Words [[gnu::vector_size(64)]] = std::uint16_t;
  using Sums [[gnu::vector_size(64)]] = std::uint32_t;

  [[gnu::always_inline]] static __m512i plain(Words words) { return reinterpret_cast<__m512i>(words); }
  [[gnu::always_inline]] static Words mulhrs(Words a, Words b) {
    return reinterpret_cast<Words>(_mm512_mulhrs_epi16(plain(a), plain(b)));
  }
  [[gnu::always_inline]] static Sums madd(Words a, Words b) {
    return reinterpret_cast<Sums>(_mm512_madd_epi16(plain(a), plain(b)));
  }
  [[gnu::always_inline]] static Sums add_madd(Sums to, Words a, Words b) {
    return reinterpret_cast<Sums>(_mm512_dpwssd_epi32(reinterpret_cast<__m512i>(to), plain(a), plain(b)));
  }
  [[gnu::always_inline]] static Words count_less(Words counts, Words a, Words b) {
    return reinterpret_cast<Words>(_mm512_mask_add_epi16(plain(counts), _mm512_cmplt_epi16_mask(plain(a), plain(b)),
                                                         plain(counts), _mm512_set1_epi16(1)));
  }
};

}  // namespace

void add_powers_avx512(PixelRows rows, PixelRows soon, std::uint16_t full_scale, PowerSums& sums) {
  VectorSummer<Avx512>(full_scale).add(rows, soon, sums);
}

}  // namespace gonio::calibration
#endif
