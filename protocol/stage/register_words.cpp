// How a value stands in registers: width, sign, word order.
#include <cassert>

#include "protocol/stage/register_map.h"

namespace gonio::stage {
namespace {

// Where the register starts inside a block; both ends must lie in it.
std::size_t offset_in(std::size_t block_size, std::uint16_t block_first, const Register& reg) {
  assert(reg.address >= block_first);
  const std::size_t offset = static_cast<std::size_t>(reg.address) - block_first;
  assert(offset + reg.words <= block_size);
  return offset;
}

bool fits(const Register& reg, std::int64_t value) {
  const std::int64_t span = std::int64_t{1} << (16 * reg.words);
  return reg.is_signed ? value >= -span / 2 && value < span / 2 : value >= 0 && value < span;
}

}  // namespace

std::int64_t decode(std::span<const std::uint16_t> block, std::uint16_t block_first, const Register& reg) {
  const std::size_t at = offset_in(block.size(), block_first, reg);
  if (reg.words == 1) return reg.is_signed ? static_cast<std::int16_t>(block[at]) : std::int64_t{block[at]};
  const std::uint32_t high = block[reg.low_word_first ? at + 1 : at];
  const std::uint32_t low = block[reg.low_word_first ? at : at + 1];
  const std::uint32_t both = (high << 16U) | low;
  return reg.is_signed ? static_cast<std::int32_t>(both) : std::int64_t{both};
}

void encode(std::span<std::uint16_t> block, std::uint16_t block_first, const Register& reg, std::int64_t value) {
  assert(fits(reg, value));
  const std::size_t at = offset_in(block.size(), block_first, reg);
  const auto both = static_cast<std::uint32_t>(value);  // two's complement, as on the wire
  const auto high = static_cast<std::uint16_t>(both >> 16U);
  const auto low = static_cast<std::uint16_t>(both & 0xFFFFU);
  block[at] = reg.words == 1 || reg.low_word_first ? low : high;
  if (reg.words == 2) block[at + 1] = reg.low_word_first ? high : low;
}

}  // namespace gonio::stage
