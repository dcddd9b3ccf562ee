// rho_dh <= 1, of the part of the hemisphere that was measured.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <span>

#include "calibration/checks/check_parts.h"
#include "calibration/cosine_weights.h"

namespace gonio::calibration {
namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;
constexpr Angle kWidestGap = degrees(60.0);
constexpr std::size_t kFewestRings = 4;

struct OnRing {
  double phi = 0.0;  ///< of dphi, in [0, 2 pi)
  const CalibratedPoint* point = nullptr;
};
struct Ring {
  double theta = 0.0;
  std::vector<OnRing> points;  ///< ascending phi
};

double turned_into_range(double phi) {
  const double turned = std::fmod(phi, kFullTurn);
  return turned < 0.0 ? turned + kFullTurn : turned;
}

// Rings of theta_r, by planned angles; an isotropic sample's points stand on both sides.
std::vector<Ring> rings_of(const std::vector<std::pair<Geometry, const CalibratedPoint*>>& points, bool isotropic) {
  std::map<std::int64_t, Ring> rings;
  for (const auto& [planned, point] : points) {
    Ring& ring = rings[std::llround(in_degrees(planned.theta_r) * 1e3)];
    ring.theta = planned.theta_r.si();
    const double phi = (planned.phi_r - planned.phi_i).si();
    ring.points.push_back({turned_into_range(phi), point});
    if (isotropic) ring.points.push_back({turned_into_range(-phi), point});
  }
  std::vector<Ring> sorted;
  for (auto& [theta, ring] : rings) {
    std::ranges::stable_sort(ring.points, {}, &OnRing::phi);
    sorted.push_back(std::move(ring));
  }
  return sorted;
}

// Trapezoids around the ring; nothing where a gap is too wide to be bridged. A ring at the normal needs one point.
std::optional<std::vector<double>> weights_around(const std::vector<OnRing>& points, bool at_normal) {
  const std::size_t n = points.size();
  if (at_normal) return std::vector<double>(n, kFullTurn / static_cast<double>(n));
  std::vector<double> weights(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    const double next = k + 1 < n ? points[k + 1].phi : points[0].phi + kFullTurn;
    const double gap = next - points[k].phi;
    if (n < 3 || gap > kWidestGap.si() * 1.001) return std::nullopt;
    weights[k] += 0.5 * gap;
    weights[(k + 1) % n] += 0.5 * gap;
  }
  return weights;
}

// The sum over the rings, linear in theta between the first and the last: what lies beyond is left out, and can only
// add. Nothing when a ring is not closed.
std::optional<std::vector<SumTerm>> terms_of(const std::vector<Ring>& rings) {
  std::vector<Angle> thetas;
  for (const Ring& ring : rings) thetas.push_back(radians(ring.theta));
  const std::vector<double> down = cosine_weights(thetas);
  std::vector<SumTerm> terms;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const auto around = weights_around(rings[r].points, rings[r].theta < 1e-6);
    if (!around) return std::nullopt;
    for (std::size_t k = 0; k < around->size(); ++k) {
      const CalibratedPoint& point = *rings[r].points[k].point;
      terms.push_back({.weight = down[r] * (*around)[k], .value = point.value, .budget = &point.budget});
    }
  }
  return terms;
}

// A point that stands there twice counts once with both weights: its own noise is one.
void merge_same(std::vector<SumTerm>& terms) {
  std::ranges::stable_sort(terms, {}, &SumTerm::budget);
  std::vector<SumTerm> once;
  for (const SumTerm& term : terms) {
    if (!once.empty() && once.back().budget == term.budget)
      once.back().weight += term.weight;
    else
      once.push_back(term);
  }
  terms = std::move(once);
}

// Every other ring and every other point on it, first and last kept.
std::vector<Ring> coarser(const std::vector<Ring>& rings) {
  std::vector<Ring> every_other;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    if (r % 2 != 0 && r + 1 != rings.size()) continue;
    double last_phi = 0.0;
    Ring ring{.theta = rings[r].theta, .points = {}};
    std::size_t azimuths = 0;  // those of points measured on both sides stand there twice
    for (const OnRing& point : rings[r].points) {
      if (ring.points.empty() || point.phi > last_phi + 1e-6) ++azimuths;
      last_phi = point.phi;
      if (azimuths % 2 == 1) ring.points.push_back(point);
    }
    every_other.push_back(std::move(ring));
  }
  return every_other;
}

struct Share {
  double value = 0.0;
  double u = 0.0;
};

// What the trapezoids miss is judged by what they miss with half the points: all of that counts as its u.
std::optional<Share> share_of(std::span<const Component> components, const std::vector<Ring>& rings) {
  if (rings.size() < kFewestRings) return std::nullopt;
  auto fine = terms_of(rings);
  if (!fine) return std::nullopt;
  merge_same(*fine);
  const auto value = weighted_sum(components, *fine);
  double missed = 0.0;
  if (auto coarse = terms_of(coarser(rings))) {
    merge_same(*coarse);
    missed = weighted_sum(components, *coarse).value.si() - value.value.si();
  } else {
    missed = value.value.si();  // too few points to tell
  }
  return Share{value.value.si(), std::hypot(value.u.si(), missed)};
}

using LightDirection = std::array<std::int64_t, 3>;  // wavelength, theta_i, phi_i

}  // namespace

ScanCheck check_energy(const CalibratedScan& calibrated, const CheckInputs& inputs) {
  ScanCheck check{.kind = CheckKind::Energy, .unit = "directions of light with rings all around"};
  const auto key = [](Angle a) { return std::llround(in_degrees(a) * 1e3); };
  std::map<std::int32_t, Geometry> planned;
  for (const PlannedPoint& point : inputs.scan.points) planned[point.index] = point.geometry;
  std::map<LightDirection, std::vector<std::pair<Geometry, const CalibratedPoint*>>> lights;
  for (const CalibratedPoint& point : calibrated.points) {
    const Geometry& g = planned[point.point_index];
    lights[{std::llround(in_nanometres(point.wavelength) * 1e3), key(g.theta_i),
            inputs.scan.isotropic ? 0 : key(wrapped(g.phi_i))}]
        .emplace_back(g, &point);
  }
  double worst_value = 0.0;
  double worst_u = 0.0;
  double worst_theta_deg = 0.0;
  double worst = -INFINITY;
  for (const auto& [light, points] : lights) {
    const auto share = share_of(calibrated.components, rings_of(points, inputs.scan.isotropic));
    if (!share || !(share->u > 0.0)) continue;
    ++check.compared;
    const double z = (share->value - 1.0) / share->u;
    if (z <= worst) continue;
    worst = z;
    worst_value = share->value;
    worst_u = share->u;
    worst_theta_deg = static_cast<double>(light[1]) * 1e-3;
    check.worst_points = {points.front().second->point_index};
  }
  if (check.compared == 0) return check;
  check.worst_z = std::max(0.0, worst);  // less than all light is what is to be
  judge_by_worst(check, check.compared);
  check.finding = fmt::format(
      "{} {}: at theta_i = {:g} deg the measured part of the hemisphere has {:.4f} +- {:.4f} (k = 1) of "
      "the light{}",
      check.compared, check.unit, worst_theta_deg, worst_value, worst_u,
      check.verdict == CheckVerdict::Failed ? ", more than there is" : "");
  return check;
}

}  // namespace gonio::calibration
