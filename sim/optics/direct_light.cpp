#include "sim/optics/direct_light.h"

#include <array>
#include <cmath>
#include <numbers>

#include "sim/optics/disc_overlap.h"
#include "sim/optics/space.h"

namespace gonio::sim {
namespace {

struct DiscPoint {
  double x = 0.0;  // of the radius
  double y = 0.0;
};

constexpr std::size_t kRings = 3;
constexpr std::size_t kOnRing = 8;

// Rings of equal area, each by its middle: means of r^2, x^2 and y^2 are exact.
std::array<DiscPoint, kRings * kOnRing> disc_points() {
  std::array<DiscPoint, kRings * kOnRing> points;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double radius = std::sqrt((static_cast<double>(k / kOnRing) + 0.5) / kRings);
    const double turn = 2.0 * std::numbers::pi * (static_cast<double>(k % kOnRing) + 0.5) / kOnRing;
    points[k] = {radius * std::cos(turn), radius * std::sin(turn)};
  }
  return points;
}

}  // namespace

SolidAngle stop_solid_angle(const Stop& stop, Length spot_radius, const Geometry& g) {
  static const auto kPoints = disc_points();
  const Angle dphi = g.phi_r - g.phi_i;  // x towards the source's azimuth
  const Vector axis = unit_vector(g.theta_r, dphi);
  const Vector across = horizontal(dphi);
  const Vector down = cross(across, axis);
  const double a = stop.radius.si();
  const Vector middle = stop.distance.si() * axis;
  double sum = 0.0;
  for (const DiscPoint& lit : kPoints) {
    const Vector from{spot_radius.si() * lit.x / std::cos(g.theta_i.si()), spot_radius.si() * lit.y, 0.0};
    for (const DiscPoint& seen : kPoints) {
      const Vector way = middle + (a * seen.x) * down + (a * seen.y) * across - from;
      const double r2 = dot(way, way);
      sum += way.z * dot(way, axis) / (axis.z * r2 * r2);
    }
  }
  const auto pairs = static_cast<double>(kPoints.size() * kPoints.size());
  return steradians(std::numbers::pi * a * a * sum / pairs);
}

double direct_light(const Stop& stop, const OverlapSpec& beams, const Geometry& g) {
  const Angle off = degrees(180.0) - phase_angle(g);
  if (off >= degrees(90.0)) return 0.0;
  std::array discs{footprint(beams.spot_radius, {}, {}), footprint(stop.radius, {}, {})};
  discs[1].centre_x_mm = in_millimetres(stop.distance) * std::tan(off.si());
  const double beam = in_millimetres(beams.spot_radius);
  const double share = common_area_mm2(discs) / (std::numbers::pi * beam * beam);
  const double omega = stop_solid_angle(stop, {}, Geometry{}).si();
  const double widths = beams.spot_radius / beams.field_radius;
  return widths * widths * std::numbers::pi / omega * share;
}

}  // namespace gonio::sim
