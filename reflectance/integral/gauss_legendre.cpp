#include "reflectance/integral/gauss_legendre.h"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <map>
#include <mutex>
#include <numbers>

namespace gonio::reflectance {
namespace {

struct LegendreValue {
  double p;
  double slope;
};

// P_n and its derivative at x in (-1, 1), by the three-term recurrence.
LegendreValue legendre(int n, double x) {
  double previous = 1.0;
  double p = x;
  for (int k = 2; k <= n; ++k) {
    const double next = ((2.0 * k - 1.0) * x * p - (k - 1.0) * previous) / k;
    previous = p;
    p = next;
  }
  return {.p = p, .slope = n * (previous - x * p) / ((1.0 - x) * (1.0 + x))};
}

UnitRule made(int size) {
  const auto count = static_cast<std::size_t>(size);
  UnitRule rule{.nodes = std::vector<double>(count), .weights = std::vector<double>(count)};
  for (std::size_t k = 0; k < (count + 1) / 2; ++k) {
    // Tricomi's first guess is close enough that five Newton steps reach the last bit.
    double x = std::cos(std::numbers::pi * (static_cast<double>(k) + 0.75) / (size + 0.5));
    for (int step = 0; step < 5; ++step) {
      const LegendreValue v = legendre(size, x);
      x -= v.p / v.slope;
    }
    if (2 * k + 1 == count) x = 0.0;
    const double slope = legendre(size, x).slope;
    const double weight = 1.0 / ((1.0 - x) * (1.0 + x) * slope * slope);
    rule.nodes[k] = 0.5 * (1.0 - x);
    rule.nodes[count - 1 - k] = 0.5 * (1.0 + x);
    rule.weights[k] = weight;
    rule.weights[count - 1 - k] = weight;
  }
  return rule;
}

}  // namespace

const UnitRule& gauss_legendre(int size) {
  assert(size >= 1);
  static std::mutex mutex;
  static std::map<int, UnitRule> rules;  // whose elements stay where they are
  const std::lock_guard lock(mutex);
  const auto known = rules.find(size);
  return known != rules.end() ? known->second : rules.emplace(size, made(size)).first->second;
}

}  // namespace gonio::reflectance
