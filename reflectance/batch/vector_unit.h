#pragma once

#include <cstdint>

namespace gonio::reflectance {

/// What the loops of this folder are compiled for, all in one program.
enum class VectorUnit : std::uint8_t {
  Baseline,  ///< what every processor of the architecture has: two lanes on x86-64, as on 64-bit ARM
  Avx2,      ///< four lanes
  Avx512,    ///< eight lanes
};

/// The widest that this processor has; asked once. Threads: any.
[[nodiscard]] VectorUnit vector_unit();

}  // namespace gonio::reflectance
