#include "calibration/drift_bridge.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gonio::calibration {
namespace {

double mode_at(std::size_t k, double p) {
  const double turns = static_cast<double>(k + 1) * std::numbers::pi;
  return std::numbers::sqrt2 * std::sin(turns * p) / turns;
}

// What the modes leave of the variance.
void add_rest(double variance, BridgeParts& parts) {
  for (const double mode : parts.mode) variance -= mode * mode;
  parts.rest = std::sqrt(std::max(0.0, variance));
}

}  // namespace

BridgeParts bridge_at(double p) {
  BridgeParts parts;
  for (std::size_t k = 0; k < kBridgeModes; ++k) parts.mode[k] = mode_at(k, p);
  add_rest(p * (1.0 - p), parts);
  return parts;
}

BridgeParts bridge_between(double p, double q) {
  BridgeParts parts;
  for (std::size_t k = 0; k < kBridgeModes; ++k) parts.mode[k] = mode_at(k, q) - mode_at(k, p);
  const double apart = std::abs(q - p);
  add_rest(apart * (1.0 - apart), parts);
  return parts;
}

}  // namespace gonio::calibration
