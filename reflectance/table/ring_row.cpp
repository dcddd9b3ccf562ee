#include "reflectance/table/ring_row.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

#include "reflectance/integral/gauss_legendre.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;

double theta_of(const Vector& r) {
  return std::atan2(std::hypot(r.x, r.y), r.z);
}

Vector vector_of(double theta, double phi) {
  return {.x = std::sin(theta) * std::cos(phi), .y = std::sin(theta) * std::sin(phi), .z = std::cos(theta)};
}

}  // namespace

RingRow::RingRow(std::vector<TableNode>& nodes, double tolerance, RowAzimuths azimuths)
    : meaning_(azimuths), is_folded_(azimuths == RowAzimuths::Folded) {
  std::vector<std::size_t> order(nodes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return theta_of(nodes[a].r) < theta_of(nodes[b].r); });
  for (const std::size_t k : order) {
    const double theta = theta_of(nodes[k].r);
    if (rings_.empty() || theta - rings_.back().theta > tolerance) rings_.push_back({.theta = theta, .nodes = {}});
    rings_.back().nodes.push_back({.phi = std::atan2(nodes[k].r.y, nodes[k].r.x), .node = k});
  }
  for (Ring& ring : rings_) {
    std::sort(ring.nodes.begin(), ring.nodes.end(), [](const RingNode& a, const RingNode& b) { return a.phi < b.phi; });
  }
  if (rings_.front().theta <= tolerance) return;
  TableNode pole{.r = {.x = 0.0, .y = 0.0, .z = 1.0}};
  const auto count = static_cast<double>(rings_.front().nodes.size());
  for (const RingNode& node : rings_.front().nodes) {
    pole.f += nodes[node.node].f / count;
    pole.u += nodes[node.node].u / count;
  }
  pole_width_ = 2.0 * rings_.front().theta;
  rings_.insert(rings_.begin(), {.theta = 0.0, .nodes = {{.phi = 0.0, .node = nodes.size()}}});
  nodes.push_back(pole);
}

std::vector<std::size_t> RingRow::nodes_of_pole() const {
  std::vector<std::size_t> nodes;
  if (pole_width_ == 0.0) return nodes;
  for (const RingNode& node : rings_[1].nodes) nodes.push_back(node.node);
  return nodes;
}

RingRow::Along RingRow::along(const Ring& ring, double phi) const {
  const std::vector<RingNode>& nodes = ring.nodes;
  if (nodes.size() == 1) {
    const double gap = is_folded_ ? std::max(2.0 * nodes[0].phi, 2.0 * (kPi - nodes[0].phi)) : 2.0 * kPi;
    return {.first = nodes[0].node, .second = nodes[0].node, .weight = 0.0, .gap = gap};
  }
  const auto above =
      std::upper_bound(nodes.begin(), nodes.end(), phi, [](double p, const RingNode& n) { return p < n.phi; });
  const bool is_end = above == nodes.begin() || above == nodes.end();
  const RingNode& b = above == nodes.end() ? nodes.front() : *above;
  const RingNode& a = above == nodes.begin() ? nodes.back() : *(above - 1);
  if (is_end && is_folded_) {
    // Between a node and its own mirror image.
    const RingNode& end = above == nodes.begin() ? b : a;
    const double gap = above == nodes.begin() ? 2.0 * end.phi : 2.0 * (kPi - end.phi);
    return {.first = end.node, .second = end.node, .weight = 0.0, .gap = gap};
  }
  const double gap = is_end ? b.phi - a.phi + 2.0 * kPi : b.phi - a.phi;
  const double past = phi < a.phi ? phi - a.phi + 2.0 * kPi : phi - a.phi;
  return {.first = a.node, .second = b.node, .weight = past / gap, .gap = gap};
}

void RingRow::add(Stencil& stencil, const Ring& ring, double phi, double weight) const {
  const Along place = along(ring, phi);
  stencil.add(place.first, weight * (1.0 - place.weight));
  if (place.weight > 0.0) stencil.add(place.second, weight * place.weight);
  if (weight > 0.0 && meaning_ != RowAzimuths::None) {
    stencil.width = std::max(stencil.width, place.gap * std::sin(ring.theta));
  }
}

Stencil RingRow::locate(const Vector& r) const {
  const double phi = is_folded_ ? std::atan2(std::abs(r.y), r.x) : std::atan2(r.y, r.x);
  const double theta = theta_of(r);
  const auto above =
      std::upper_bound(rings_.begin(), rings_.end(), theta, [](double t, const Ring& g) { return t < g.theta; });
  Stencil stencil{.place = r};
  if (above == rings_.end() || above == rings_.begin()) {
    const Ring& ring = above == rings_.end() ? rings_.back() : rings_.front();
    stencil.is_inside = theta - ring.theta <= 1e-12;
    if (!stencil.is_inside) stencil.place = vector_of(ring.theta, std::atan2(r.y, r.x));
    add(stencil, ring, phi, 1.0);
    return stencil;
  }
  const Ring& inner = *(above - 1);
  const double step = above->theta - inner.theta;
  const double weight = (theta - inner.theta) / step;
  stencil.width = above - rings_.begin() == 1 ? std::max(step, pole_width_) : step;
  add(stencil, inner, phi, 1.0 - weight);
  add(stencil, *above, phi, weight);
  return stencil;
}

std::vector<Stencil> RingRow::locate_without(std::size_t k) const {
  std::vector<Stencil> found;
  for (std::size_t g = 0; g < rings_.size(); ++g) {
    const auto own =
        std::find_if(rings_[g].nodes.begin(), rings_[g].nodes.end(), [&](const RingNode& n) { return n.node == k; });
    if (own == rings_[g].nodes.end()) continue;
    const bool is_end = own == rings_[g].nodes.begin() || own + 1 == rings_[g].nodes.end();
    if (rings_[g].nodes.size() > 2 && !(is_folded_ && is_end)) {
      Ring rest = rings_[g];
      rest.nodes.erase(rest.nodes.begin() + (own - rings_[g].nodes.begin()));
      add(found.emplace_back(), rest, own->phi, 1.0);
    }
    if (g > 0 && g + 1 < rings_.size()) {
      const double weight = (rings_[g].theta - rings_[g - 1].theta) / (rings_[g + 1].theta - rings_[g - 1].theta);
      Stencil& across = found.emplace_back();
      add(across, rings_[g - 1], own->phi, 1.0 - weight);
      add(across, rings_[g + 1], own->phi, weight);
    }
  }
  return found;
}

// Where either ring bends, as a closed list of azimuths over one turn.
std::vector<double> RingRow::azimuths(const Ring& inner, const Ring& outer) const {
  std::vector<double> phi{-kPi, kPi};
  for (const Ring* ring : {&inner, &outer}) {
    for (const RingNode& node : ring->nodes) {
      phi.push_back(node.phi);
      if (is_folded_) phi.push_back(-node.phi);
    }
  }
  for (int k = -3; k < 4; ++k)
    phi.push_back(0.25 * kPi * k);  // no cell is so wide that a cosine of phi bends much in it
  std::sort(phi.begin(), phi.end());
  phi.erase(std::unique(phi.begin(), phi.end()), phi.end());
  return phi;
}

void RingRow::quadrature(int order, const QuadratureSink& sink) const {
  const UnitRule rule = gauss_legendre(order);
  for (std::size_t g = 0; g < rings_.size(); ++g) {
    const Ring& inner = rings_[g];
    const bool is_last = g + 1 == rings_.size();
    const Ring& outer = is_last ? inner : rings_[g + 1];
    const double step = (is_last ? 0.5 * kPi : outer.theta) - inner.theta;
    if (step <= 0.0) continue;
    const std::vector<double> phi = azimuths(inner, outer);
    for (std::size_t c = 0; c + 1 < phi.size(); ++c) {
      const double turn = phi[c + 1] - phi[c];
      for (std::size_t j = 0; j < rule.nodes.size(); ++j) {
        const double theta = inner.theta + rule.nodes[j] * step;
        for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
          sink(vector_of(theta, phi[c] + rule.nodes[k] * turn),
               rule.weights[j] * rule.weights[k] * step * turn * std::sin(theta));
        }
      }
    }
  }
}

}  // namespace gonio::reflectance
