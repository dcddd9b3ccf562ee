#include "reflectance/measured/pair_nodes.h"

#include <array>
#include <cmath>
#include <numbers>
#include <variant>

#include <fmt/format.h>

#include "reflectance/integral/gauss_legendre.h"
#include "reflectance/table/feature_motion.h"

namespace gonio::reflectance {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

struct PolarSize {
  int arcs;
  int azimuths;
};

PolarSize polar_size(NodeLevel level) {
  return level == NodeLevel::Coarse ? PolarSize{32, 36} : PolarSize{40, 60};
}

// [0, 1] onto itself, dense at both ends, at a lobe's end more so; and its slope.
struct Place {
  double t;
  double slope;
};

Place stretched(double s, Feature feature) {
  const double t = s * s * (3.0 - 2.0 * s);
  const double slope = 6.0 * s * (1.0 - s);
  if (feature != Feature::Lobe) return {.t = t, .slope = slope};
  return {.t = t * std::sqrt(t), .slope = 1.5 * std::sqrt(t) * slope};
}

Error no_light(std::string seen, std::string limit) {
  return {.code = ErrorCode::InvalidInput,
          .tried = "integrate a scan under a light",
          .seen = std::move(seen),
          .limit = std::move(limit)};
}

void add_beam(const Beam& beam, double weight, std::vector<HemisphereNode>& nodes) {
  nodes.push_back({.direction = beam.direction(), .weight_sr = weight * beam.irradiance()});
}

// Rings of equal solid angle about the middle, without what lies below the horizon.
void add_disk(const SunDisk& disk, double weight, std::vector<HemisphereNode>& nodes) {
  constexpr int kRings = 4;
  constexpr int kAzimuths = 8;
  const SunPlace& place = disk.place();
  const double one_minus = 2.0 * std::pow(std::sin(0.5 * place.radius.si()), 2);  // 1 - cos(radius)
  const double each = kTurn * one_minus / (kRings * kAzimuths);
  const double c = std::cos(place.theta.si());
  const double s = std::sin(place.theta.si());
  for (int k = 0; k < kRings; ++k) {
    const double cos_xi = 1.0 - one_minus * (k + 0.5) / kRings;
    const double sin_xi = std::sqrt(1.0 - cos_xi * cos_xi);
    for (int j = 0; j < kAzimuths; ++j) {
      const double psi = kTurn * (j + 0.5) / kAzimuths;
      const Vector v{.x = cos_xi * s - sin_xi * std::cos(psi) * c,
                     .y = sin_xi * std::sin(psi),
                     .z = cos_xi * c + sin_xi * std::cos(psi) * s};
      if (v.z <= 0.0) continue;
      const Direction level = Direction::from_vector(v);
      const Direction i = Direction::from_cosine(level.mu(), level.sin_theta(), level.phi() + place.phi);
      nodes.push_back({.direction = i, .weight_sr = weight * disk.radiance() * each * i.mu()});
    }
  }
}

void add_sky(const Sky& sky, double weight, bool only_zenith_angle, NodeLevel level,
             std::vector<HemisphereNode>& nodes) {
  const int rings = level == NodeLevel::Coarse ? 12 : 16;
  for (const HemisphereNode& node : gauss_rings(rings, 2 * rings)) {
    const double lit = weight * sky.radiance(node.direction) * node.weight_sr;
    const Direction zenith_angle = Direction::from_cosine(node.direction.mu(), node.direction.sin_theta(), Angle{});
    if (only_zenith_angle && !nodes.empty() && nodes.back().direction == zenith_angle) {
      nodes.back().weight_sr += lit;
    } else {
      nodes.push_back({.direction = only_zenith_angle ? zenith_angle : node.direction, .weight_sr = lit});
    }
  }
}

}  // namespace

std::vector<HemisphereNode> feature_nodes(const Direction& axis, Feature feature, NodeLevel level) {
  const double side = feature == Feature::Lobe ? -1.0 : 1.0;
  const IncidenceTilt tilt =
      feature == Feature::Smooth ? IncidenceTilt{} : IncidenceTilt{.mu = axis.mu(), .sin_theta = axis.sin_theta()};
  const PolarSize size = polar_size(level);
  const UnitRule& rule = gauss_legendre(size.arcs);
  std::vector<HemisphereNode> nodes;
  for (int j = 0; j < size.azimuths; ++j) {
    const double psi = kTurn * (j + 0.5) / size.azimuths;
    const double length = arc_to_horizon(tilt, std::cos(psi));
    for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
      const Place place = stretched(rule.nodes[k], feature);
      const double xi = length * place.t;
      const double x = std::cos(xi) * tilt.sin_theta - std::sin(xi) * std::cos(psi) * tilt.mu;
      const Vector v{.x = side * x,
                     .y = std::sin(xi) * std::sin(psi),
                     .z = std::max(0.0, std::cos(xi) * tilt.mu + std::sin(xi) * std::cos(psi) * tilt.sin_theta)};
      const Direction level_r = Direction::from_vector(v);
      const Direction r = Direction::from_cosine(level_r.mu(), level_r.sin_theta(), level_r.phi() + axis.phi());
      const double solid_angle = rule.weights[k] * place.slope * length * std::sin(xi) * kTurn / size.azimuths;
      nodes.push_back({.direction = r, .weight_sr = solid_angle * r.mu()});
    }
  }
  return nodes;
}

std::vector<HemisphereNode> incidence_nodes(bool is_isotropic, NodeLevel level) {
  const int rings = level == NodeLevel::Coarse ? 9 : 12;
  std::vector<HemisphereNode> nodes = gauss_rings(rings, is_isotropic ? 1 : 8);
  if (!is_isotropic) return nodes;
  for (HemisphereNode& node : nodes) {
    node.direction = Direction::from_cosine(node.direction.mu(), node.direction.sin_theta(), Angle{});
  }
  return nodes;
}

Result<std::vector<HemisphereNode>> light_nodes(const Light& light, bool only_zenith_angle, NodeLevel level) {
  std::vector<HemisphereNode> nodes;
  for (const LightPart& part : light.parts()) {
    if (const auto* beam = std::get_if<Beam>(&part.source)) add_beam(*beam, part.weight, nodes);
    if (const auto* disk = std::get_if<SunDisk>(&part.source)) add_disk(*disk, part.weight, nodes);
    if (const auto* sky = std::get_if<Sky>(&part.source)) add_sky(*sky, part.weight, only_zenith_angle, level, nodes);
  }
  double irradiance = 0.0;
  for (const HemisphereNode& node : nodes) {
    if (!std::isfinite(node.weight_sr) || node.weight_sr < 0.0) {
      return failure(no_light(fmt::format("the light from theta {:.6g} deg is no finite number at least 0",
                                          in_degrees(node.direction.theta())),
                              "a radiance of 0 or more"));
    }
    irradiance += node.weight_sr;
  }
  if (!(irradiance > 0.0)) return failure(no_light("E_d = 0", "some light on the surface"));
  return nodes;
}

}  // namespace gonio::reflectance
