#include "sim/optics/mounting.h"

#include <cmath>

#include "sim/optics/space.h"

namespace gonio::sim {
namespace {

// Turns the nominal normal z into the leaning one, about the horizontal axis across the lean. `back` = -1 undoes it.
class Lean {
 public:
  explicit Lean(const MountSpec& mount)
      : angle_(std::hypot(mount.lean_0.si(), mount.lean_90.si())),
        axis_(angle_ == 0.0 ? Vector{1.0, 0.0, 0.0}
                            : Vector{-mount.lean_90.si() / angle_, mount.lean_0.si() / angle_, 0.0}) {}

  [[nodiscard]] Vector normal() const { return turned({0.0, 0.0, 1.0}, angle_); }
  [[nodiscard]] Vector in_surface(const Vector& lab) const { return turned(lab, -angle_); }

 private:
  [[nodiscard]] Vector turned(const Vector& v, double angle) const {
    const double c = std::cos(angle);
    return c * v + std::sin(angle) * cross(axis_, v) + (1.0 - c) * dot(axis_, v) * axis_;
  }

  double angle_;
  Vector axis_;
};

SurfacePoint point_of(const Vector& v) {
  return {.x = Length::from_si(v.x), .y = Length::from_si(v.y)};
}

}  // namespace

MountedView view_on(const MountSpec& mount, Length source_distance, Length detector_distance, const Geometry& g) {
  const Lean lean(mount);
  const Vector normal = lean.normal();
  const Vector middle{0.0, 0.0, mount.height.si()};
  const Vector to_source = unit_vector(g.theta_i, g.phi_i);
  const Vector to_detector = unit_vector(g.theta_r, g.phi_r);
  const auto pierced = [&](const Vector& axis) { return (dot(normal, middle) / dot(normal, axis)) * axis; };
  const Vector seen = pierced(to_detector);
  const Vector lit_from = source_distance.si() * to_source - seen;
  const Vector seen_from = detector_distance.si() * to_detector - seen;

  const Vector i = lean.in_surface(lit_from);
  const Vector r = lean.in_surface(to_detector);
  return {.geometry = {.theta_i = polar_angle(i), .phi_i = azimuth(i), .theta_r = polar_angle(r), .phi_r = azimuth(r)},
          .source_near = source_distance.si() / length(lit_from),
          .detector_near = detector_distance.si() / length(seen_from),
          .spot = point_of(lean.in_surface(pierced(to_source) - middle)),
          .field = point_of(lean.in_surface(seen - middle))};
}

}  // namespace gonio::sim
