#pragma once

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <vector>

namespace gonio::bench {

/// What some work took: by the clock on the wall, and of all of this process's threads on the processors.
struct MeasuredTime {
  double wall_s = 0.0;
  double cpu_s = 0.0;
};

[[nodiscard]] inline double processor_seconds() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

[[nodiscard]] MeasuredTime time_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  const double cpu = processor_seconds();
  work();
  return {.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          .cpu_s = processor_seconds() - cpu};
}

/// Of both by itself.
[[nodiscard]] inline MeasuredTime median(const std::vector<MeasuredTime>& times) {
  const auto of = [&](double MeasuredTime::*part) {
    std::vector<double> values;
    for (const MeasuredTime& t : times) values.push_back(t.*part);
    std::ranges::sort(values);
    return values[values.size() / 2];
  };
  return {.wall_s = of(&MeasuredTime::wall_s), .cpu_s = of(&MeasuredTime::cpu_s)};
}

}  // namespace gonio::bench
