#include "reflectance/integral/hemisphere_integral.h"

#include <cassert>
#include <cmath>
#include <numbers>

#include "reflectance/integral/gauss_legendre.h"
#include "reflectance/integral/refinement.h"

namespace gonio::reflectance {
namespace {

constexpr int kFirstLevel = 3;  // 8 rings
constexpr int kLastLevel = 8;   // 256 rings of 512 directions

RuleSum ring_sum(const std::function<double(const Direction&)>& s, int rings, RingSpacing spacing) {
  RuleSum sum;
  for (const HemisphereNode& node : gauss_rings(rings, 2 * rings, spacing)) sum.add(node.weight_sr * s(node.direction));
  return sum;
}

}  // namespace

std::vector<HemisphereNode> gauss_rings(int rings, int azimuths, RingSpacing spacing) {
  assert(rings >= 1 && azimuths >= 1);
  const UnitRule& rule = gauss_legendre(rings);
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

Integral integrate_hemisphere(const std::function<double(const Direction&)>& s, double relative_tolerance,
                              RingSpacing spacing) {
  return refined(kFirstLevel, kLastLevel, relative_tolerance,
                 [&](int level) { return ring_sum(s, 1 << level, spacing); });
}

}  // namespace gonio::reflectance
