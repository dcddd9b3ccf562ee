#include "base/large_array.h"

#include <sanitizer/asan_interface.h>
#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <new>

#include "base/free_ranges.h"

namespace gonio {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20U;
constexpr std::size_t kKeptAtMost = std::size_t{1} << 30U;  // about what reducing a million points needs

std::size_t in_whole_pages(std::size_t bytes) {
  return (bytes + kHugePage - 1) / kHugePage * kHugePage;
}

// Aligned: what is too much of a longer stretch goes back.
std::byte* map_pages(std::size_t bytes) {
  void* const found =
      mmap(nullptr, bytes + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (found == MAP_FAILED) throw std::bad_alloc();
  auto* const first = static_cast<std::byte*>(found);
  const std::size_t before = kHugePage - reinterpret_cast<std::uintptr_t>(found) % kHugePage;
  (void)munmap(first, before);
  if (before < kHugePage) (void)munmap(first + before + bytes, kHugePage - before);
  (void)madvise(first + before, bytes, MADV_HUGEPAGE);  // a system without them says so
  return first + before;
}

/// Pages that were given back and are still mapped. The system may empty them when it needs memory.
class KeptPages {
 public:
  std::byte* take(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    return free_.take(bytes);
  }
  void give(std::byte* at, std::size_t bytes) {
    const bool has_room = [&] {
      const std::lock_guard lock(mutex_);
      return free_.bytes() + bytes <= kKeptAtMost;
    }();
    if (!has_room || madvise(at, bytes, MADV_FREE) != 0) {
      ASAN_UNPOISON_MEMORY_REGION(at, bytes);
      (void)munmap(at, bytes);
      return;
    }
    ASAN_POISON_MEMORY_REGION(at, bytes);
    const std::lock_guard lock(mutex_);
    free_.add(at, bytes);
  }

 private:
  std::mutex mutex_;
  FreeRanges free_;
};

KeptPages& kept_pages() {
  static auto* const pages = new KeptPages;  // outlives every array
  return *pages;
}

}  // namespace

// What the address sanitizer is told is nothing in any other build: whoever reads behind an array, or after its end, is
// found as on the heap.
void* allocate_large(std::size_t bytes) {
  if (bytes < kHugePage) return ::operator new(bytes);
  const std::size_t whole = in_whole_pages(bytes);
  std::byte* const kept = kept_pages().take(whole);
  std::byte* const memory = kept != nullptr ? kept : map_pages(whole);
  ASAN_UNPOISON_MEMORY_REGION(memory, bytes);
  ASAN_POISON_MEMORY_REGION(memory + bytes, whole - bytes);
  return memory;
}

void free_large(void* memory, std::size_t bytes) {
  if (bytes < kHugePage) {
    ::operator delete(memory);
  } else {
    kept_pages().give(static_cast<std::byte*>(memory), in_whole_pages(bytes));
  }
}

}  // namespace gonio
