#include <cmath>
#include <numbers>
#include <span>

#include "bench/reflectance/quadrature.h"
#include "reflectance/integral/hemisphere_integral.h"

namespace gonio::bench {
namespace {

using namespace gonio::reflectance;

using Nodes = std::vector<HemisphereNode>;
constexpr double kPi = std::numbers::pi;

Estimate weighted_sum(const Case& c, const Direction& i, std::span<const HemisphereNode> nodes) {
  double sum = 0.0;
  for (const HemisphereNode& node : nodes) sum += node.weight_sr * in_per_steradian(c.surface.eval(i, node.direction));
  return {sum, nodes.size()};
}

// The trapezoidal rule in theta and phi, both in steps of `step_deg`.
Nodes trapezoid(double step_deg) {
  const int thetas = static_cast<int>(std::lround(90.0 / step_deg));
  const int phis = 4 * thetas;
  const double step = 0.5 * kPi / thetas;
  Nodes nodes;
  for (int t = 0; t <= thetas; ++t) {
    for (int p = 0; p < phis; ++p) {
      const Direction d = Direction::from_angles(radians(std::min(t * step, 0.5 * kPi)), radians(p * step));
      nodes.push_back({d, (t == 0 || t == thetas ? 0.5 : 1.0) * step * step * d.mu() * d.sin_theta()});
    }
  }
  return nodes;
}

// Points of equal mu dOmega on a spiral that turns by the golden angle (Vogel 1979).
Nodes spiral(int count) {
  const double turn = kPi * (3.0 - std::sqrt(5.0));
  Nodes nodes;
  for (int k = 0; k < count; ++k) {
    const double sin2 = (k + 0.5) / count;
    const Direction d = Direction::from_cosine(std::sqrt(1.0 - sin2), std::sqrt(sin2), radians(k * turn));
    nodes.push_back({d, kPi / count});
  }
  return nodes;
}

template <class Make, class Settings, class Text>
Method method(std::string name, const Settings& settings, Make make, Text text) {
  const auto rungs = [=](const Case& c) {
    std::vector<Rung> all;
    for (const auto& setting : settings) {
      const auto run = [&c, i = c.incidence(), nodes = make(setting)] { return weighted_sum(c, i, nodes); };
      all.push_back({text(setting), repeated(run)});
    }
    return all;
  };
  return {std::move(name), Family::Grid, rungs};
}

}  // namespace

std::vector<Method> grid_methods() {
  const std::vector<double> steps_deg = {10, 5, 2, 1, 0.5, 0.25};
  const std::vector<int> rings = {4, 8, 16, 32, 64, 128, 256};
  const std::vector<int> counts = {128, 360, 1368, 8280, 32768, 131072, 524288};
  const auto step_text = [](double step) {
    return step >= 1.0 ? std::to_string(static_cast<int>(step)) + " deg" : std::to_string(step).substr(0, 4) + " deg";
  };
  const auto ring_text = [](int n) { return std::to_string(n) + "x" + std::to_string(2 * n); };
  const auto count_text = [](int n) { return std::to_string(n); };
  return {
      method("trapezoid", steps_deg, trapezoid, step_text),
      method(
          "Gauss in mu", rings, [](int n) { return gauss_rings(n, 2 * n, RingSpacing::Mu); }, ring_text),
      method(
          "Gauss in sqrt(mu)", rings, [](int n) { return gauss_rings(n, 2 * n, RingSpacing::SqrtMu); }, ring_text),
      method("spiral", counts, spiral, count_text),
  };
}

}  // namespace gonio::bench
