#include "reflectance/integral/tanh_sinh.h"

#include <cassert>
#include <cmath>
#include <numbers>

namespace gonio::reflectance {

std::vector<EndNode> tanh_sinh(int level) {
  assert(level >= 0 && level <= 8);
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

}  // namespace gonio::reflectance
