#pragma once

#include <cstddef>
#include <map>

namespace gonio {

/// Ranges of memory that nobody uses, by address; those that touch are one. Owns none of them. Threads: one.
class FreeRanges {
 public:
  /// [at, at + bytes) overlaps none that is there.
  void add(std::byte* at, std::size_t bytes);
  /// The front of the smallest range that has room for it, taken out. Null: none has.
  [[nodiscard]] std::byte* take(std::size_t bytes);
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  std::map<std::byte*, std::size_t> ranges_;
  std::size_t bytes_ = 0;  ///< of all
};

}  // namespace gonio
