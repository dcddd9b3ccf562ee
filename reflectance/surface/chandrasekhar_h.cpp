#include "reflectance/surface/chandrasekhar_h.h"

#include <cassert>
#include <cstddef>
#include <numbers>

#include "reflectance/integral/compensated_sum.h"
#include "reflectance/integral/tanh_sinh.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;

// One node of the integral over x: everything that does not depend on mu.
struct Node {
  double weighted_log;  ///< weight ln(1 - omega0 x cot x)
  double cos2;
  double sin2;
};

// 1 - x cot x = x^2/(3 - x^2/(5 - x^2/(7 - ...))) for x in [0, pi/2]: all terms keep their sign and nothing cancels at
// 0.
double one_minus_x_cot_x(double x) {
  const double x2 = x * x;
  double denominator = 31.0;
  for (double odd = 29.0; odd >= 3.0; odd -= 2.0) denominator = odd - x2 / denominator;
  return x2 / denominator;
}

// Double-exponential nodes: the logarithm is singular at x = 0 without loss, the denominator peaks at pi/2 for small
// mu.
std::vector<Node> integral_nodes(double one_minus_omega0) {
  std::vector<Node> nodes;
  for (const EndNode& node : tanh_sinh(6)) {
    const double x = 0.5 * kPi * node.x;
    const double c = std::sin(0.5 * kPi * node.rest);
    const double s = std::sin(x);
    const double omega0 = 1.0 - one_minus_omega0;
    // Towards pi/2, which is all that a small mu sees, the argument is 1 but for x cot x.
    const double log =
        node.x > 0.5 ? std::log1p(-omega0 * x * c / s) : std::log(one_minus_omega0 + omega0 * one_minus_x_cot_x(x));
    nodes.push_back({.weighted_log = 0.5 * kPi * node.weight * log, .cos2 = c * c, .sin2 = s * s});
  }
  return nodes;
}

double log_h(const std::vector<Node>& nodes, double mu) {
  CompensatedSum sum;
  for (const Node& node : nodes) sum.add(node.weighted_log / (node.cos2 + mu * mu * node.sin2));
  return -mu / kPi * sum.value();
}

// cos(pi m / (2 size)): a large m is taken back by whole turns first, where its product with pi would round.
double chebyshev_cosine(std::size_t m, std::size_t size) {
  return std::cos(0.5 * kPi * static_cast<double>(m % (4 * size)) / static_cast<double>(size));
}

// Coefficients of the powers of t of the polynomial through f at the Chebyshev points of [-1, 1].
template <std::size_t size, class F>
std::array<double, size> fitted(F f) {
  std::array<double, size> samples;
  for (std::size_t j = 0; j < size; ++j) samples[j] = f(chebyshev_cosine(2 * j + 1, size));
  std::array<double, size> powers{};
  std::array<double, size> older{};    // T_{k-1}
  std::array<double, size> current{};  // T_k
  current[0] = 1.0;
  for (std::size_t k = 0; k < size; ++k) {
    CompensatedSum sum;
    for (std::size_t j = 0; j < size; ++j) sum.add(samples[j] * chebyshev_cosine(k * (2 * j + 1), size));
    const double c = sum.value() * (k == 0 ? 1.0 : 2.0) / size;
    for (std::size_t n = 0; n < size; ++n) powers[n] += c * current[n];
    std::array<double, size> next{};
    for (std::size_t n = 0; n + 1 < size; ++n) next[n + 1] = (k == 0 ? 1.0 : 2.0) * current[n];
    for (std::size_t n = 0; n < size; ++n) next[n] -= older[n];
    older = current;
    current = next;
  }
  return powers;
}

}  // namespace

ChandrasekharH::ChandrasekharH(double one_minus_omega0) {
  assert(one_minus_omega0 >= 0.0 && one_minus_omega0 <= 1.0);
  const std::vector<Node> nodes = integral_nodes(one_minus_omega0);
  std::vector<Octave> octaves;
  for (int k = 0; k < kOctaves; ++k) {
    octaves.push_back(fitted<kDegree + 1>([&](double t) { return log_h(nodes, std::ldexp(0.25 * (t + 3.0), -k)); }));
  }
  octaves_ = std::make_shared<const std::vector<Octave>>(std::move(octaves));
}

}  // namespace gonio::reflectance
