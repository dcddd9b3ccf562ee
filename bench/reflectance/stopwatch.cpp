#include "bench/reflectance/stopwatch.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstddef>

namespace gonio::bench {

double seconds_of(const std::function<void()>& run) {
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  assert(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> interleaved_medians(const std::vector<Timed>& all, int rounds) {
  constexpr double kFill = 1e-4;
  constexpr double kLong = 2e-2;  // such calls are their own average: three rounds do
  std::vector<std::vector<double>> seconds(all.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t n = 0; n < all.size(); ++n) {
      if (round >= 3 && all[n].rough_s > kLong) continue;
      const int repeats = std::max(1, static_cast<int>(std::min(1e4, kFill / std::max(all[n].rough_s, 1e-9))));
      const auto many = [&] {
        for (int k = 0; k < repeats; ++k) all[n].run();
      };
      seconds[n].push_back(seconds_of(many) / repeats);
    }
  }
  std::vector<double> medians;
  for (std::vector<double>& s : seconds) medians.push_back(median(std::move(s)));
  return medians;
}

}  // namespace gonio::bench
