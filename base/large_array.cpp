#include "base/large_array.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace gonio {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20U;

std::size_t in_whole_pages(std::size_t bytes) {
  return (bytes + kHugePage - 1) / kHugePage * kHugePage;
}

}  // namespace

void* allocate_large(std::size_t bytes) {
  const bool is_large = bytes >= kHugePage;
  void* memory = is_large ? std::aligned_alloc(kHugePage, in_whole_pages(bytes)) : std::malloc(bytes);
  if (memory == nullptr && bytes > 0) throw std::bad_alloc();
  if (is_large) (void)madvise(memory, in_whole_pages(bytes), MADV_HUGEPAGE);  // a system without them says so
  return memory;
}

void free_large(void* memory) {
  std::free(memory);
}

}  // namespace gonio
