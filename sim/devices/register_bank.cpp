#include "sim/devices/register_bank.h"

#include <array>

namespace gonio::sim {

void RegisterBank::add(const stage::Register& reg, bool is_writable) {
  for (unsigned k = 0; k < reg.words; ++k) {
    words_[static_cast<std::uint16_t>(reg.address + k)].is_writable |= is_writable;
  }
}

std::optional<ModbusException> RegisterBank::read(std::uint16_t first, std::span<std::uint16_t> out) const {
  for (std::size_t k = 0; k < out.size(); ++k) {
    const auto found = words_.find(static_cast<std::uint16_t>(first + k));
    if (found == words_.end()) return ModbusException::IllegalAddress;
    out[k] = found->second.value;
  }
  return std::nullopt;
}

std::optional<ModbusException> RegisterBank::write(std::uint16_t first, std::span<const std::uint16_t> values) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto found = words_.find(static_cast<std::uint16_t>(first + k));
    if (found == words_.end() || !found->second.is_writable) return ModbusException::IllegalAddress;
  }
  for (std::size_t k = 0; k < values.size(); ++k) words_[static_cast<std::uint16_t>(first + k)].value = values[k];
  return std::nullopt;
}

std::int64_t RegisterBank::get(const stage::Register& reg) const {
  std::array<std::uint16_t, 2> words{};
  const auto part = std::span(words).first(reg.words);
  [[maybe_unused]] const auto refused = read(reg.address, part);
  return stage::decode(part, reg.address, reg);
}

void RegisterBank::set(const stage::Register& reg, std::int64_t value) {
  std::array<std::uint16_t, 2> words{};
  const auto part = std::span(words).first(reg.words);
  const unsigned bits = 16U * reg.words;
  const auto low = static_cast<std::int64_t>(static_cast<std::uint64_t>(value) & ((std::uint64_t{1} << bits) - 1));
  stage::Register plain = reg;
  plain.is_signed = false;
  stage::encode(part, reg.address, plain, low);
  for (std::size_t k = 0; k < part.size(); ++k) words_[static_cast<std::uint16_t>(reg.address + k)].value = part[k];
}

void RegisterBank::clear() {
  for (auto& [address, word] : words_) word.value = 0;
}

bool is_covered(const stage::Register& reg, std::uint16_t first, std::size_t count) {
  return reg.address >= first && std::size_t{reg.address} + reg.words <= std::size_t{first} + count;
}

}  // namespace gonio::sim
