#include "reflectance/measured/cap_rim.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonio::reflectance {
namespace {

constexpr double kRimDeg = 20.0;

double farther_deg(const DirectionPair& pair) {
  return in_degrees(std::max(pair.i.theta(), pair.r.theta()));
}

struct Rim {
  std::vector<SeenNode> nodes;
  double edge_deg = 0.0;
  double measured = 0.0;
};

Rim rim_of(const std::vector<SeenNode>& seen) {
  Rim rim;
  for (const SeenNode& one : seen) rim.edge_deg = std::max(rim.edge_deg, farther_deg(one.node.pair));
  for (const SeenNode& one : seen) {
    if (farther_deg(one.node.pair) < rim.edge_deg - kRimDeg) continue;
    rim.nodes.push_back(one);
    rim.measured += one.term;
  }
  return rim;
}

struct Misfit {
  double off = 0.0;    ///< the four integrals' sizes together
  double given = 0.0;  ///< by the surface, all four
};

Misfit misfit(const Rim& rim, const Surface& surface) {
  Misfit misfit;
  std::array<double, 4> off{};
  for (const auto& [node, term] : rim.nodes) {
    const std::size_t is_inner = farther_deg(node.pair) < rim.edge_deg - 0.5 * kRimDeg ? 1 : 0;
    const std::size_t is_behind = std::cos(azimuth_difference(node.pair.i, node.pair.r).si()) < 0.0 ? 1 : 0;
    const double given = node.weight * surface.eval(node.pair.i, node.pair.r).si();
    off[2 * is_inner + is_behind] += term - given;
    misfit.given += given;
  }
  for (const double part : off) misfit.off += std::abs(part);
  return misfit;
}

}  // namespace

CapDoubt doubt_of(const CapModel& cap, const std::vector<SeenNode>& seen) {
  CapDoubt doubt{.u_relative = cap.u_lack_of_fit, .rival_weights = {}};
  for (const CapModel::Rival& rival : cap.rivals) doubt.rival_weights.push_back(rival.weight);
  const Rim rim = rim_of(seen);
  const Misfit own = misfit(rim, cap.surface);
  if (own.given == 0.0 || rim.measured == 0.0) return doubt;
  // By what the cap gives: one that gives next to nothing at the rim gives as little beyond.
  doubt.u_relative = own.off / std::abs(own.given);
  const double least = 1e-3 * std::abs(rim.measured);  // nobody's readings are better
  double total = 1.0 / std::max(least, own.off);
  for (std::size_t m = 0; m < cap.rivals.size(); ++m) {
    doubt.rival_weights[m] = 1.0 / std::max(least, misfit(rim, cap.rivals[m].surface).off);
    total += doubt.rival_weights[m];
  }
  for (double& weight : doubt.rival_weights) weight /= total;
  return doubt;
}

}  // namespace gonio::reflectance
