#include "bench/reflectance/stopwatch.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <ctime>

namespace gonio::bench {
namespace {

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// The first call met cold caches; a short one is asked again.
double warm_seconds(const Timed& timed) {
  constexpr double kShort = 1e-4;
  constexpr long kRepeats = 16;
  if (timed.rough_s > kShort) return timed.rough_s;
  return seconds_of([&] { timed.run(kRepeats); }) / kRepeats;
}

}  // namespace

double seconds_of(const std::function<void()>& run) {
  const double start = thread_seconds();
  run();
  return thread_seconds() - start;
}

double median(std::vector<double> values) {
  assert(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> interleaved_medians(const std::vector<Timed>& all, int rounds) {
  constexpr double kFill = 3e-4;
  constexpr double kLong = 2e-2;  // such calls are their own average: three rounds do
  std::vector<std::vector<double>> seconds(all.size());
  std::vector<double> rough;
  for (const Timed& timed : all) rough.push_back(warm_seconds(timed));
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t n = 0; n < all.size(); ++n) {
      if (round >= 3 && rough[n] > kLong) continue;
      const auto repeats = std::max(1L, std::lround(std::min(1e5, kFill / std::max(rough[n], 1e-9))));
      seconds[n].push_back(seconds_of([&] { all[n].run(repeats); }) / static_cast<double>(repeats));
    }
  }
  std::vector<double> medians;
  for (std::vector<double>& s : seconds) medians.push_back(median(std::move(s)));
  return medians;
}

}  // namespace gonio::bench
