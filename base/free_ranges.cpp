#include "base/free_ranges.h"

#include <iterator>

namespace gonio {

void FreeRanges::add(std::byte* at, std::size_t bytes) {
  bytes_ += bytes;
  const auto range = ranges_.emplace(at, bytes).first;
  const auto next = std::next(range);
  if (next != ranges_.end() && at + bytes == next->first) {
    range->second += next->second;
    ranges_.erase(next);
  }
  if (range == ranges_.begin()) return;
  const auto before = std::prev(range);
  if (before->first + before->second != at) return;
  before->second += range->second;
  ranges_.erase(range);
}

std::byte* FreeRanges::take(std::size_t bytes) {
  auto best = ranges_.end();
  for (auto range = ranges_.begin(); range != ranges_.end(); ++range) {
    if (range->second >= bytes && (best == ranges_.end() || range->second < best->second)) best = range;
  }
  if (best == ranges_.end()) return nullptr;
  const auto [at, had] = *best;
  ranges_.erase(best);
  if (had > bytes) ranges_.emplace(at + bytes, had - bytes);
  bytes_ -= bytes;
  return at;
}

}  // namespace gonio
