#include "reflectance/integral/tanh_sinh.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <numbers>

namespace gonio::reflectance {
namespace {

constexpr int kLevels = 9;

std::vector<EndNode> made(int level) {
  constexpr double kReach = 3.5;  // x = 3e-23 there, with weights below 1e-20: nothing is lost beyond
  const double step = std::ldexp(1.0, -level);
  const int half = static_cast<int>(kReach / step);
  std::vector<EndNode> rule;
  for (int k = -half; k <= half; ++k) {
    const double t = k * step;
    const double u = std::numbers::pi * std::sinh(t);
    // x = 1/(1 + exp(-u)): both x and 1 - x without subtraction.
    const double x = 1.0 / (1.0 + std::exp(-u));
    const double rest = 1.0 / (1.0 + std::exp(u));
    rule.push_back({.x = x, .rest = rest, .weight = step * std::numbers::pi * std::cosh(t) * x * rest});
  }
  return rule;
}

}  // namespace

const std::vector<EndNode>& tanh_sinh(int level) {
  assert(level >= 0 && level < kLevels);
  static std::array<std::once_flag, kLevels> once;
  static std::array<std::vector<EndNode>, kLevels> rules;
  const auto k = static_cast<std::size_t>(level);
  std::call_once(once[k], [&] { rules[k] = made(level); });
  return rules[k];
}

}  // namespace gonio::reflectance
