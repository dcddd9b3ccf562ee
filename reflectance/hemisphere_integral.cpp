#include "reflectance/hemisphere_integral.h"

#include <cassert>
#include <cmath>
#include <numbers>

#include "reflectance/gauss_legendre.h"

namespace gonio::reflectance {
namespace {

constexpr int kFirstRings = 8;
constexpr int kMostRings = 256;
constexpr double kRounding = 4e-16;  // of a sum of weighted positive terms

struct Sums {
  double value = 0.0;
  double size = 0.0;  ///< of |s|: what a relative tolerance means where s changes sign
  std::uint64_t evaluations = 0;
};

Sums ring_sums(const std::function<double(const Direction&)>& s, int rings) {
  Sums sums;
  for (const HemisphereNode& node : gauss_rings(rings, 2 * rings)) {
    const double term = node.weight_sr * s(node.direction);
    sums.value += term;
    sums.size += std::abs(term);
    ++sums.evaluations;
  }
  return sums;
}

}  // namespace

std::vector<HemisphereNode> gauss_rings(int rings, int azimuths, RingSpacing spacing) {
  assert(rings >= 1 && azimuths >= 1);
  const UnitRule rule = gauss_legendre(rings);
  const double step = 2.0 * std::numbers::pi / azimuths;
  std::vector<HemisphereNode> nodes;
  nodes.reserve(static_cast<std::size_t>(rings) * static_cast<std::size_t>(azimuths));
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    const double x = rule.nodes[k];
    const double mu = spacing == RingSpacing::Mu ? x : x * x;
    const double share = spacing == RingSpacing::Mu ? mu : 2.0 * x * mu;  // mu dmu
    const double sin_theta = std::sqrt((1.0 - mu) * (1.0 + mu));
    for (int j = 0; j < azimuths; ++j) {
      nodes.push_back({.direction = Direction::from_cosine(mu, sin_theta, radians((j + 0.5) * step)),
                       .weight_sr = rule.weights[k] * share * step});
    }
  }
  return nodes;
}

Integral integrate_hemisphere(const std::function<double(const Direction&)>& s, double relative_tolerance) {
  Sums coarse = ring_sums(s, kFirstRings);
  Integral result{.evaluations = coarse.evaluations};
  for (int rings = 2 * kFirstRings; rings <= kMostRings; rings *= 2) {
    const Sums fine = ring_sums(s, rings);
    result.value = fine.value;
    result.error = std::abs(fine.value - coarse.value) + kRounding * fine.size;
    result.evaluations += fine.evaluations;
    if (result.error <= relative_tolerance * fine.size) break;
    coarse = fine;
  }
  return result;
}

}  // namespace gonio::reflectance
