#include "bench/wires/contest.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>
#include <vector>

namespace gonio::bench {
namespace {

// Of values in any order, linear between neighbours.
double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  const double at = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

double timed(int exchanges, const std::function<bool()>& exchange) {
  constexpr int kWarmUp = 2;
  for (int k = 0; k < kWarmUp; ++k) {
    if (!exchange()) return 0.0;
  }
  const auto start = std::chrono::steady_clock::now();
  for (int k = 0; k < exchanges; ++k) {
    if (!exchange()) return 0.0;
  }
  return exchanges / std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// A frame may be lost on a busy machine, by anybody: a stretch is tried again before it counts as failed.
double tried(const Stretch& stretch) {
  constexpr int kTries = 3;
  double rate = 0.0;
  for (int k = 0; k < kTries && rate <= 0.0; ++k) rate = stretch();
  return rate;
}

}  // namespace

double per_second(int exchanges, const std::function<bool()>& exchange) {
  double rate = 0.0;
  std::thread([&] { rate = timed(exchanges, exchange); }).join();
  return rate;
}

void print_heading() {
  fmt::print("{:<58} {:>10} {:>10} {:>7}  {:<15} {}\n", "exchanges a second, medians of rounds in turns", "ours",
             "bare", "ratio", "quartiles", "verdict");
}

bool hold(const Contest& contest, int rounds) {
  std::vector<double> ours, bare, ratios;
  for (int k = 0; k < rounds; ++k) {
    double a = 0.0;
    if (k % 2 == 0) a = tried(contest.ours);
    const double b = tried(contest.bare);
    if (k % 2 != 0) a = tried(contest.ours);
    if (a <= 0.0 || b <= 0.0) {
      fmt::print("{:<58} an exchange of {} failed\n", contest.what, a <= 0.0 ? "ours" : "the bare loop");
      return false;
    }
    ours.push_back(a);
    bare.push_back(b);
    ratios.push_back(a / b);
  }
  const double ratio = quantile(ratios, 0.5);
  const bool holds = ratio >= kLeastRatio;
  fmt::print("{:<58} {:>10.0f} {:>10.0f} {:>7.3f}  {:.3f} to {:.3f}  {}\n", contest.what, quantile(ours, 0.5),
             quantile(bare, 0.5), ratio, quantile(ratios, 0.25), quantile(ratios, 0.75),
             holds ? "holds" : fmt::format("BELOW {}", kLeastRatio));
  std::fflush(stdout);
  return holds;
}

}  // namespace gonio::bench
