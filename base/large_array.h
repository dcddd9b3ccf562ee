#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

namespace gonio {

/// Memory for arrays of many megabytes: from 2 MiB on in whole pages of that size where the system has them (Linux,
/// transparent huge pages), so that touching it first costs one page fault where it would have cost 512. Pages that are
/// given back stay mapped, 1 GiB of them at most, for the next array: clearing fresh ones takes longer than much of
/// what is done in them. The system is told that nothing in them counts (MADV_FREE) and takes them when it is short of
/// memory. Throws std::bad_alloc. Threads: any.
[[nodiscard]] void* allocate_large(std::size_t bytes);
/// `bytes`: as it was asked for.
void free_large(void* memory, std::size_t bytes);

/// std::vector's memory by `allocate_large`. Elements that a `resize` adds are left as the memory is, for threads that
/// write them later: nobody reads one before.
template <class T>
struct LargeAllocator {
  using value_type = T;

  LargeAllocator() = default;
  template <class U>
  LargeAllocator(const LargeAllocator<U>& /*other*/) {}  // NOLINT(google-explicit-constructor): a vector converts them

  [[nodiscard]] T* allocate(std::size_t n) { return static_cast<T*>(allocate_large(n * sizeof(T))); }
  void deallocate(T* memory, std::size_t n) { free_large(memory, n * sizeof(T)); }

  template <class U>
  void construct(U* /*at*/) {
    static_assert(std::is_trivially_copyable_v<U>, "its life begins with its memory (C++20: implicit-lifetime)");
  }
  template <class U, class First, class... Rest>
  void construct(U* at, First&& first, Rest&&... rest) {
    ::new (static_cast<void*>(at)) U(std::forward<First>(first), std::forward<Rest>(rest)...);
  }
  friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }
};

/// Elements by the million. Plain data may be made by `resize` and filled later.
template <class T>
using LargeArray = std::vector<T, LargeAllocator<T>>;

}  // namespace gonio
