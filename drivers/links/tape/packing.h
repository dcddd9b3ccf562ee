#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace gonio::drivers {

/// CRC-32 of a record's payload (ISO 3309, as in gzip and PNG).
[[nodiscard]] std::uint32_t crc32_of(std::span<const std::uint8_t> bytes);

/// Pixels, lossless: each as its difference to the one before (modulo 2^16, so that a small difference of either sign
/// is a small number: 0, -1, 1, -2 ... become 0, 1, 2, 3), all low bytes, then all high bytes, then deflate (RFC 1951
/// in a zlib stream, RFC 1950) at its fastest level.
[[nodiscard]] std::vector<std::uint8_t> pack_pixels(std::span<const std::uint16_t> pixels);
/// `count` pixels, no more and no fewer. Errors: IncompleteData. Makes nothing larger than `count` asks for.
[[nodiscard]] Result<std::vector<std::uint16_t>> unpack_pixels(std::span<const std::uint8_t> packed, std::size_t count);

}  // namespace gonio::drivers
