#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace gonio::calibration {

/// A hash of whole numbers: SplitMix64's steps (Steele, Lea and Flood 2014), one a number.
[[nodiscard]] inline std::size_t mixed(std::initializer_list<std::int64_t> parts) {
  constexpr std::uint64_t kMix = 0xBF58476D1CE4E5B9ULL;
  std::uint64_t z = 0;
  for (const std::int64_t part : parts) {
    z = (z ^ static_cast<std::uint64_t>(part)) * kMix;
    z ^= z >> 29U;
  }
  return z;
}

/// Numbers keys as they first appear, from 0. `Key` has == and `hash()`. Threads: one.
template <class Key>
class KeyNumbers {
 public:
  /// Whoever asks for keys in the order in which they first came, or back again, or for the same one twice, gets them
  /// without a search.
  std::uint32_t number_of(const Key& key) {
    if (next_ < keys_.size() && keys_[next_] == key) return next_++;
    return number_elsewhere(key);
  }

  /// By number.
  [[nodiscard]] const std::vector<Key>& keys() const { return keys_; }

 private:
  static constexpr std::uint32_t kFree = ~std::uint32_t{0};

  // A few steps back, or anywhere.
  [[gnu::noinline]] std::uint32_t number_elsewhere(const Key& key) {
    for (const std::size_t likely : {std::size_t{next_} - 1, std::size_t{next_} - 2, std::size_t{next_} - 3}) {
      if (likely < keys_.size() && keys_[likely] == key) return found(static_cast<std::uint32_t>(likely));
    }
    if (2 * (keys_.size() + 1) > slots_.size()) grow();
    std::uint32_t& slot = slot_of(key);
    if (slot == kFree) {
      slot = static_cast<std::uint32_t>(keys_.size());
      keys_.push_back(key);
    }
    return found(slot);
  }
  std::uint32_t found(std::uint32_t number) {
    next_ = number + 1;
    return number;
  }
  // Open addressing: the key's slot, or the free one where it belongs.
  std::uint32_t& slot_of(const Key& key) {
    std::size_t slot = key.hash() & (slots_.size() - 1);
    while (slots_[slot] != kFree && !(keys_[slots_[slot]] == key)) slot = (slot + 1) & (slots_.size() - 1);
    return slots_[slot];
  }
  void grow() {
    constexpr std::size_t kFirst = 128;  // a power of two, as all that follow
    slots_.assign(slots_.empty() ? kFirst : 2 * slots_.size(), kFree);
    for (std::size_t n = 0; n < keys_.size(); ++n) slot_of(keys_[n]) = static_cast<std::uint32_t>(n);
  }

  std::vector<Key> keys_;
  std::vector<std::uint32_t> slots_;
  std::uint32_t next_ = 0;
};

}  // namespace gonio::calibration
