#include "calibration/drift_bridge.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace gonio::calibration {
namespace {

// sin(k x) of k = 1, 2, .. by sin((k + 1) x) = 2 cos(x) sin(k x) - sin((k - 1) x): one sine and one cosine for all.
std::array<double, kBridgeModes> modes_at(double p) {
  const double cosine = std::cos(std::numbers::pi * p);
  double before = 0.0;
  double sine = std::sin(std::numbers::pi * p);
  std::array<double, kBridgeModes> modes{};
  for (std::size_t k = 0; k < kBridgeModes; ++k) {
    modes[k] = std::numbers::sqrt2 * sine / (static_cast<double>(k + 1) * std::numbers::pi);
    before = std::exchange(sine, 2.0 * cosine * sine - before);
  }
  return modes;
}

// What the modes leave of the variance.
void add_rest(double variance, BridgeParts& parts) {
  for (const double mode : parts.mode) variance -= mode * mode;
  parts.rest = std::sqrt(std::max(0.0, variance));
}

}  // namespace

BridgeParts bridge_at(double p) {
  BridgeParts parts{.mode = modes_at(p)};
  add_rest(p * (1.0 - p), parts);
  return parts;
}

BridgeParts bridge_between(double p, double q) {
  BridgeParts parts{.mode = modes_at(q)};
  const auto at_p = modes_at(p);
  for (std::size_t k = 0; k < kBridgeModes; ++k) parts.mode[k] -= at_p[k];
  const double apart = std::abs(q - p);
  add_rest(apart * (1.0 - apart), parts);
  return parts;
}

}  // namespace gonio::calibration
