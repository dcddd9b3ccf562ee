#include "reflectance/light/rings.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "reflectance/integral/gauss_legendre.h"
#include "reflectance/integral/tanh_sinh.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<EndNode> gauss_nodes(int size) {
  const UnitRule rule = gauss_legendre(size);
  std::vector<EndNode> nodes;
  for (std::size_t k = 0; k < rule.nodes.size(); ++k) {
    nodes.push_back({.x = rule.nodes[k], .rest = 1.0 - rule.nodes[k], .weight = rule.weights[k]});
  }
  return nodes;
}

// Gauss in the square root of x, which takes up the powers of mu that a BRDF has at the horizon.
std::vector<EndNode> gauss_from_horizon(int size) {
  std::vector<EndNode> nodes = gauss_nodes(size);
  for (EndNode& node : nodes) {
    node.weight *= 2.0 * node.x;
    node.rest *= 1.0 + node.x;
    node.x *= node.x;
  }
  return nodes;
}

// Thetas between which the sky is smooth, as elevations from the horizon upwards.
std::vector<double> elevation_breaks(const Sky& sky) {
  std::vector<double> cuts{0.0, 0.5 * kPi};
  for (const Angle theta : sky.theta_breaks()) cuts.push_back(0.5 * kPi - theta.si());
  if (const std::optional<Direction> peak = sky.peak()) cuts.push_back(peak->elevation().si());
  std::ranges::sort(cuts);
  // Not ranges::unique: its subrange does not build with clang 14.
  const auto doubled = std::unique(cuts.begin(), cuts.end(), [](double a, double b) { return b - a < 1e-12; });
  cuts.erase(doubled, cuts.end());
  cuts.back() = 0.5 * kPi;
  return cuts;
}

// One piece of a disk, as offsets of theta from its centre's.
struct Span {
  double from;
  double to;
  bool is_full;  // rings that lie in the disk all around
};

// What of the ring at theta_c + offset lies within the disk: half its width in azimuth, by
//   sin^2(width/2) = sin((a + offset)/2) sin((a - offset)/2) / (sin theta sin theta_c),
// and 1 minus it likewise, so that neither a thin end nor a nearly full ring loses digits.
double half_width(double below, double above, double over_pole, double pole_gap) {
  const double in = std::sin(0.5 * below) * std::sin(0.5 * above);
  const double out = std::sin(0.5 * over_pole) * std::sin(0.5 * pole_gap);
  return 2.0 * std::atan2(std::sqrt(std::max(0.0, in)), std::sqrt(std::max(0.0, out)));
}

std::vector<Span> disk_spans(const SunPlace& p) {
  const double theta = p.theta.si();
  const double a = p.radius.si();
  const double to = std::min(a, 0.5 * kPi - theta);
  if (theta >= a) return {{-a, to, false}};
  std::vector<Span> spans{{-theta, a - 2.0 * theta, true}};
  if (theta > 0.0) spans.push_back({a - 2.0 * theta, to, false});
  return spans;
}

void add_span(const SunDisk& disk, const Span& span, const std::vector<EndNode>& rule, std::vector<Ring>& rings) {
  const double theta_c = disk.place().theta.si();
  const double a = disk.place().radius.si();
  const double length = span.to - span.from;
  const double floor = std::max(0.0, 0.5 * kPi - theta_c - span.to);
  for (const EndNode& node : rule) {
    // sin^2: square roots at the ends of the span become smooth.
    const double sine = std::sin(0.5 * kPi * node.x);
    const double cosine = std::sin(0.5 * kPi * node.rest);
    const double up = length * sine * sine;
    const double down = length * cosine * cosine;
    const double elevation = floor + down;
    if (elevation <= 0.0 || length <= 0.0) continue;
    const double theta = theta_c + span.from + up;
    const Direction at = elevation < 0.25 * kPi
                             ? Direction::from_elevation(radians(elevation), disk.place().phi)
                             : Direction::from_angles(radians(std::max(0.0, theta)), disk.place().phi);
    const double width = span.is_full
                             ? kPi
                             : half_width((a + span.from) + up, (a - span.to) + down,
                                          2.0 * theta_c + span.from + a + up, (2.0 * theta_c + span.from - a) + up);
    const double d_theta = length * kPi * sine * cosine * node.weight;
    rings.push_back({.at = at, .half_width = width, .weight_sr = 2.0 * width * at.mu() * at.sin_theta() * d_theta});
  }
}

}  // namespace

std::vector<Ring> sky_rings(const Sky& sky, int level) {
  const std::vector<double> cuts = elevation_breaks(sky);
  const std::vector<EndNode> from_horizon = gauss_from_horizon(4 << level);
  const std::vector<EndNode> towards_peak = tanh_sinh(level);
  const std::vector<EndNode> between = gauss_nodes(1 << level);
  const double peak = sky.peak() ? sky.peak()->elevation().si() : -1.0;
  std::vector<Ring> rings;
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const double length = cuts[k + 1] - cuts[k];
    const bool meets_peak = std::abs(cuts[k] - peak) < 1e-12 || std::abs(cuts[k + 1] - peak) < 1e-12;
    for (const EndNode& node : meets_peak ? towards_peak : k == 0 ? from_horizon : between) {
      const double elevation = std::min(0.5 * kPi, cuts[k] + length * node.x);
      const Direction at = Direction::from_elevation(radians(elevation), Angle{});
      rings.push_back(
          {.at = at, .half_width = kPi, .weight_sr = 2.0 * kPi * at.mu() * at.sin_theta() * length * node.weight});
    }
  }
  return rings;
}

std::vector<AzimuthNode> sky_azimuths(const Sky& sky, int level) {
  std::vector<AzimuthNode> nodes;
  if (const std::optional<Direction> peak = sky.peak()) {
    for (const EndNode& node : tanh_sinh(std::min(level + 1, 6))) {
      for (const double side : {-kPi, kPi}) {
        nodes.push_back({.phi = peak->phi() + radians(side * node.x), .share = 0.5 * node.weight});
      }
    }
    return nodes;
  }
  const std::vector<Angle> breaks = sky.phi_breaks();
  if (breaks.size() > 1) {
    const std::vector<EndNode> rule = gauss_nodes(1 << level);
    for (std::size_t k = 0; k < breaks.size(); ++k) {
      const bool closes = k + 1 == breaks.size();
      const double length = closes ? (breaks[0] - breaks[k]).si() + 2.0 * kPi : (breaks[k + 1] - breaks[k]).si();
      for (const EndNode& node : rule) {
        nodes.push_back({.phi = breaks[k] + radians(length * node.x), .share = node.weight * length / (2.0 * kPi)});
      }
    }
    return nodes;
  }
  const int count = 4 << level;
  for (int k = 0; k < count; ++k) {
    nodes.push_back({.phi = radians((k + 0.5) * 2.0 * kPi / count), .share = 1.0 / count});
  }
  return nodes;
}

std::vector<Ring> disk_rings(const SunDisk& disk, int level) {
  const std::vector<EndNode> rule = disk.is_cut() ? tanh_sinh(level) : gauss_nodes(2 << level);
  std::vector<Ring> rings;
  for (const Span& span : disk_spans(disk.place())) add_span(disk, span, rule, rings);
  return rings;
}

}  // namespace gonio::reflectance
