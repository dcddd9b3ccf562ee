#include "reflectance/measured/node_sum.h"

#include <cmath>
#include <utility>

#include "reflectance/measured/cap_rim.h"

namespace gonio::reflectance {
namespace {

// Adds what the cap gives at the nodes that were not covered.
void add_cap(const CapModel& cap, std::span<const PairNode> nodes, NodeSum& sum) {
  std::vector<double> slope(cap.parameters.size(), 0.0);
  sum.rival_modelled.assign(cap.rivals.size(), 0.0);
  for (const CapModel::Rival& rival : cap.rivals) sum.rival_weight.push_back(rival.weight);
  for (const PairNode& node : nodes) {
    const auto at = [&](const Surface& s) { return node.weight * s.eval(node.pair.i, node.pair.r).si(); };
    const double base = at(cap.surface);
    sum.modelled += base;
    for (std::size_t p = 0; p < slope.size(); ++p) {
      slope[p] += (at(cap.parameters[p].shifted) - base) / cap.parameters[p].shift;
    }
    for (std::size_t m = 0; m < cap.rivals.size(); ++m) sum.rival_modelled[m] += at(cap.rivals[m].surface);
  }
  for (std::size_t p = 0; p < slope.size(); ++p) {
    const std::vector<double>& per_reading = cap.parameters[p].per_reading;
    for (std::size_t j = 0; j < per_reading.size(); ++j) sum.weight[j] += slope[p] * per_reading[j];
  }
}

}  // namespace

NodeSum node_sum(const MeasuredScan& scan, const ScanInterpolant& interpolant, const std::optional<CapModel>& cap,
                 std::span<const PairNode> nodes) {
  NodeSum sum;
  sum.weight.assign(scan.points.size(), 0.0);
  std::vector<PairNode> uncovered;
  std::vector<ReadingShare> shares;
  std::vector<SeenNode> seen;
  const bool is_doubtful = cap && cap->u_lack_of_fit > 0.0;
  for (const PairNode& node : nodes) {
    shares.clear();
    const bool is_covered = interpolant.shares(node.pair.i, node.pair.r, shares);
    if (!is_covered && cap) {
      uncovered.push_back(node);
      continue;
    }
    double value = 0.0;
    for (const ReadingShare& share : shares) {
      sum.weight[share.reading] += node.weight * share.weight;
      value += share.weight * scan.points[share.reading].value.si();
    }
    (is_covered ? sum.measured : sum.modelled) += node.weight * value;
    if (is_doubtful) seen.push_back({.node = node, .term = node.weight * value});
  }
  if (cap) add_cap(*cap, uncovered, sum);
  if (is_doubtful) {
    CapDoubt doubt = doubt_of(*cap, seen);
    sum.u_lack_of_fit = doubt.u_relative * std::abs(sum.modelled);
    sum.rival_weight = std::move(doubt.rival_weights);
  }
  return sum;
}

NodeSum bare_node_sum(const ScanInterpolant& interpolant, std::span<const PairNode> nodes) {
  NodeSum sum;
  for (const PairNode& node : nodes) {
    const double term = node.weight * interpolant.eval(node.pair.i, node.pair.r).si();
    (interpolant.covers(node.pair.i, node.pair.r) ? sum.measured : sum.modelled) += term;
  }
  return sum;
}

SumUncertainty sum_uncertainty(const MeasuredScan& scan, std::span<const double> weight) {
  double random2 = 0.0;
  std::vector<double> shared(scan.components.size(), 0.0);
  for (std::size_t j = 0; j < weight.size(); ++j) {
    if (weight[j] == 0.0) continue;
    const MeasuredPoint& p = scan.points[j];
    random2 += weight[j] * weight[j] * p.u_random.si() * p.u_random.si();
    for (const SharedEffect& e : p.shared) shared[e.component] += weight[j] * e.per_sd.si();
  }
  double shared2 = 0.0;
  for (const double s : shared) shared2 += s * s;
  return {.random = std::sqrt(random2), .shared = std::sqrt(shared2)};
}

}  // namespace gonio::reflectance
