// E_d and E_u of one source: rings of the sky, or arcs of a disk, times rho_dh.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "reflectance/integral/directional_reflectance.h"
#include "reflectance/integral/gauss_legendre.h"
#include "reflectance/integral/refinement.h"
#include "reflectance/light/lit_integral_parts.h"
#include "reflectance/light/rings.h"

namespace gonio::reflectance {
namespace {

constexpr int kFirstLevel = 1;
constexpr int kLastLevel = 6;
constexpr double kDoubt = 0.25;       // a sky may be any function
constexpr int kLastProductLevel = 4;  // of a surface that needs rho_dh at each azimuth too

// A direction that light comes from, and how much of it.
struct LitNode {
  Direction i;
  double irradiance;
};

Direction turned(const Direction& at, Angle phi) {
  return Direction::from_cosine(at.mu(), at.sin_theta(), phi);
}

// Ring by ring: the mean radiance around stands for all of it.
void add_ring_means(const Sky& sky, int level, Watch& watch, std::vector<LitNode>& nodes) {
  const std::vector<AzimuthNode> around = sky_azimuths(sky, level);
  for (const Ring& ring : sky_rings(sky, level)) {
    double mean = 0.0;
    if (const std::optional<double> closed = watch.ring_mean(sky, ring.at)) {
      mean = *closed;
    } else {
      for (const AzimuthNode& node : around) mean += node.share * watch.radiance(sky, turned(ring.at, node.phi));
    }
    nodes.push_back({.i = ring.at, .irradiance = ring.weight_sr * mean});
  }
}

void add_grid(const Sky& sky, int level, Watch& watch, std::vector<LitNode>& nodes) {
  const std::vector<AzimuthNode> around = sky_azimuths(sky, level);
  for (const Ring& ring : sky_rings(sky, level)) {
    for (const AzimuthNode& node : around) {
      const Direction i = turned(ring.at, node.phi);
      nodes.push_back({.i = i, .irradiance = ring.weight_sr * node.share * watch.radiance(sky, i)});
    }
  }
}

void add_disk(const SunDisk& disk, int level, bool is_zonal, std::vector<LitNode>& nodes) {
  const UnitRule along = gauss_legendre(2 << level);
  for (const Ring& ring : disk_rings(disk, level)) {
    const double irradiance = ring.weight_sr * disk.radiance();
    if (is_zonal) {
      nodes.push_back({.i = ring.at, .irradiance = irradiance});
      continue;
    }
    for (std::size_t k = 0; k < along.nodes.size(); ++k) {
      const Angle off = radians(ring.half_width * (2.0 * along.nodes[k] - 1.0));
      nodes.push_back({.i = turned(ring.at, disk.place().phi + off), .irradiance = irradiance * along.weights[k]});
    }
  }
}

std::vector<LitNode> lit_nodes(const LightSource& source, int level, bool is_zonal, Watch& watch) {
  std::vector<LitNode> nodes;
  if (const auto* disk = std::get_if<SunDisk>(&source)) add_disk(*disk, level, is_zonal, nodes);
  if (const auto* sky = std::get_if<Sky>(&source)) {
    if (is_zonal)
      add_ring_means(*sky, level, watch, nodes);
    else
      add_grid(*sky, level, watch, nodes);
  }
  return nodes;
}

double total_of(const std::vector<LitNode>& nodes) {
  double total = 0.0;
  for (const LitNode& node : nodes) total += node.irradiance;
  return total;
}

// What counts little need not be known well: all nodes together may be two fifths of the tolerance off.
double tolerance_for(const LitNode& node, double total, std::size_t nodes, double relative_tolerance) {
  const double share = node.irradiance / total;
  const double even = 0.3 * relative_tolerance / (share * static_cast<double>(nodes));
  return std::clamp(even, 0.1 * relative_tolerance, 1e-2);
}

RuleSum sent_up_at(const Surface& leaf, const LightSource& source, int level, double relative_tolerance, Watch& watch) {
  const std::uint64_t before = watch.radiances();
  const std::vector<LitNode> nodes = lit_nodes(source, level, leaf.is_isotropic(), watch);
  const double total = total_of(nodes);
  RuleSum sum;
  sum.add(Integral{.evaluations = watch.radiances() - before}, 0.0);
  for (const LitNode& node : nodes) {
    if (node.irradiance <= 0.0 || watch.error()) continue;
    sum.add(rho_dh(leaf, node.i, tolerance_for(node, total, nodes.size(), relative_tolerance)), node.irradiance);
  }
  return sum;
}

RuleSum irradiance_at(const LightSource& source, int level, Watch& watch) {
  const std::uint64_t before = watch.radiances();
  RuleSum sum;
  for (const LitNode& node : lit_nodes(source, level, true, watch)) {
    sum.add(Integral::closed(node.irradiance), 1.0);
  }
  sum.add(Integral{.evaluations = watch.radiances() - before}, 0.0);
  return sum;
}

}  // namespace

Integral irradiance_of(const LightSource& source, double relative_tolerance, Watch& watch) {
  if (const auto* beam = std::get_if<Beam>(&source)) return Integral::closed(beam->irradiance());
  if (const auto* disk = std::get_if<SunDisk>(&source); disk != nullptr && !disk->is_cut()) {
    // The projected solid angle of a whole disk: pi sin^2(radius) cos(theta).
    const double sine = std::sin(disk->place().radius.si());
    const double mu = Direction::from_angles(disk->place().theta, Angle{}).mu();
    return Integral::closed(disk->radiance() * std::numbers::pi * sine * sine * mu);
  }
  const auto at_level = [&](int level) { return irradiance_at(source, level, watch); };
  Integral result = refined(kFirstLevel, kLastLevel, relative_tolerance, at_level, kDoubt);
  // Where the horizon cuts a disk is known to the rounding of its angles.
  constexpr double kAngleRounding = 1e-15;
  if (const auto* disk = std::get_if<SunDisk>(&source)) {
    result.error += result.value * kAngleRounding / disk->place().radius.si();
  }
  return result;
}

Integral sent_up(const Surface& leaf, const LightSource& source, double relative_tolerance, Watch& watch) {
  if (const auto* beam = std::get_if<Beam>(&source)) {
    Integral result;
    result.add(rho_dh(watched(leaf, watch), beam->direction(), relative_tolerance), beam->irradiance());
    return result;
  }
  const Surface seen = watched(leaf, watch);
  const int last = leaf.is_isotropic() ? kLastLevel : kLastProductLevel;
  const auto at_level = [&](int level) { return sent_up_at(seen, source, level, relative_tolerance, watch); };
  return refined(kFirstLevel, last, relative_tolerance, at_level, kDoubt);
}

}  // namespace gonio::reflectance
