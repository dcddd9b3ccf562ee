#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "tests/fuzz/byte_source.h"

namespace gonio::fuzz {

/// A neighbour of `input`: bytes changed, inserted, removed, repeated, numbers at their edges, or the tail of `other`.
/// Few and plain: what finds paths is libFuzzer, this only walks about where it has been.
[[nodiscard]] std::vector<std::uint8_t> mutated(Bytes input, Bytes other, std::mt19937_64& chance);

}  // namespace gonio::fuzz
