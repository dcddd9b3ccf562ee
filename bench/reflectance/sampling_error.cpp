#include "bench/reflectance/sampling_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "reflectance/integral/hemisphere_integral.h"

namespace gonio::bench {
namespace {

using namespace gonio::reflectance;

const std::vector<HemisphereNode>& nodes() {
  static const std::vector<HemisphereNode> kNodes = gauss_rings(400, 800, RingSpacing::SqrtMu);
  return kNodes;
}

double f(const Surface& s, const Direction& i, const Direction& r) {
  return in_per_steradian(s.eval(i, r));
}

}  // namespace

DensityError table_error(const Surface& s, const Direction& i, const TableSampler& table, double rho_dh) {
  double misplaced = 0.0;
  for (const HemisphereNode& node : nodes()) {
    const double drawn = table.density_per_sr(node.direction) / node.direction.mu();
    misplaced += 0.5 * node.weight_sr * std::abs(drawn - f(s, i, node.direction) / rho_dh);
  }
  return {.rho = std::abs(table.report().rho_dh - rho_dh) / rho_dh, .misplaced = misplaced};
}

DensityError literal_error(const Surface& s, const Direction& i, LiteralCells cells, double rho_dh) {
  const double theta_step = 0.5 * std::numbers::pi / cells.theta;
  const double phi_step = 2.0 * std::numbers::pi / cells.phi;
  const auto in_middle = [&](const Direction& r) {
    const double phi = r.phi().si() < 0.0 ? r.phi().si() + 2.0 * std::numbers::pi : r.phi().si();
    const double t = std::min(std::floor(r.theta().si() / theta_step), cells.theta - 1.0);
    const double p = std::min(std::floor(phi / phi_step), cells.phi - 1.0);
    return f(s, i, Direction::from_angles(radians((t + 0.5) * theta_step), radians((p + 0.5) * phi_step)));
  };
  double rho = 0.0;
  for (const HemisphereNode& node : nodes()) rho += node.weight_sr * in_middle(node.direction);
  double misplaced = 0.0;
  for (const HemisphereNode& node : nodes()) {
    const double off = in_middle(node.direction) / rho - f(s, i, node.direction) / rho_dh;
    misplaced += 0.5 * node.weight_sr * std::abs(off);
  }
  return {.rho = LiteralSampler::make(s, cells).value().rho_dh_error(i), .misplaced = misplaced};
}

DensityError cosine_error(const Surface& s, const Direction& i, double rho_dh) {
  double variance = 0.0;
  for (const HemisphereNode& node : nodes()) {
    const double weight = std::numbers::pi * f(s, i, node.direction) / rho_dh;
    variance += node.weight_sr / std::numbers::pi * (weight - 1.0) * (weight - 1.0);
  }
  return {.weight_sd = std::sqrt(variance)};
}

double greatest_brdf(const Surface& s, const Direction& i) {
  double greatest = std::max(f(s, i, i), f(s, i, mirrored(i)));
  for (const HemisphereNode& node : nodes()) greatest = std::max(greatest, f(s, i, node.direction));
  return 1.01 * greatest;
}

}  // namespace gonio::bench
