#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "drivers/links/tape/tape_record.h"

namespace gonio::drivers {

/// What a tape file begins with: a name that no text editor keeps whole, and the version of the layout (README.md).
inline constexpr std::array<std::uint8_t, 12> kTapeMagic{'G', 'O', 'N', 'I', 'O', 'T', 'A', 'P', 0x0D, 0x0A, 0x1A, 1};
/// Length and CRC-32 of a record's payload, 4 bytes each.
inline constexpr std::size_t kTapeRecordHead = 8;
/// Of a record's payload; a longer one is damage.
inline constexpr std::size_t kMostPayload = std::size_t{64} << 20U;
/// Of a frame on the tape.
inline constexpr std::size_t kMostPixels = std::size_t{64} << 20U;

/// A record's payload, without its head.
[[nodiscard]] std::vector<std::uint8_t> encode_record(const TapeRecord& record);
/// Errors: IncompleteData (not a payload of this version).
[[nodiscard]] Result<TapeRecord> decode_record(std::span<const std::uint8_t> payload);

}  // namespace gonio::drivers
