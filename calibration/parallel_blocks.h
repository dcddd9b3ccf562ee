#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace gonio::calibration {

/// As many threads as asked for, or as the machine has (0), but no more than there are blocks; at least 1.
[[nodiscard]] inline std::size_t threads_for(int asked, std::size_t blocks) {
  const std::size_t most = asked > 0 ? static_cast<std::size_t>(asked) : std::thread::hardware_concurrency();
  return std::clamp<std::size_t>(most, 1, std::max<std::size_t>(blocks, 1));
}

/// Calls `work(block)` for every block below `blocks`, once each, on up to `threads` threads (0: as the machine has),
/// the caller's own among them; returns when all are done. What a block does may depend on nothing but its number: so
/// the result is the same for any number of threads. `work` must not throw.
template <class Work>
void for_blocks(std::size_t blocks, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto take = [&] {
    for (std::size_t block = next.fetch_add(1); block < blocks; block = next.fetch_add(1)) work(block);
  };
  std::vector<std::thread> others;
  for (std::size_t n = 1; n < threads_for(threads, blocks); ++n) others.emplace_back(take);
  take();
  for (std::thread& other : others) other.join();
}

}  // namespace gonio::calibration
