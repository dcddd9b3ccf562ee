#pragma once

#include "base/result.h"
#include "base/units.h"
#include "reflectance/direction/direction.h"

namespace gonio::reflectance {

/// Where a disk of light stands. `theta` may exceed 90 deg by less than the radius: then less than half of it is up.
struct SunPlace {
  Angle theta;
  Angle phi;
  Angle radius = degrees(0.2665);  ///< the sun's mean angular radius; above 0, at most 45 deg
};

/// A disk of even radiance on the sky, 0 outside of it: the sun, a lamp's aperture. What has set gives no light.
class SunDisk {
 public:
  /// `radiance` finite, at least 0. Errors: InvalidInput, naming the field; the whole disk below the horizon is one.
  [[nodiscard]] static Result<SunDisk> make(const SunPlace& place, double radiance);
  /// From E_n, what the whole disk lays on a plane across the direction of its centre: L = E_n / (pi sin^2(radius)).
  /// Errors: InvalidInput.
  [[nodiscard]] static Result<SunDisk> make_from_normal_irradiance(const SunPlace& place, double normal_irradiance);

  [[nodiscard]] const SunPlace& place() const { return place_; }
  [[nodiscard]] double radiance() const { return radiance_; }
  /// Whether light comes from there.
  [[nodiscard]] bool covers(const Direction& i) const;
  /// Whether the horizon cuts it.
  [[nodiscard]] bool is_cut() const;

 private:
  SunDisk(const SunPlace& place, double radiance) : place_(place), radiance_(radiance) {}
  SunPlace place_;
  double radiance_;
};

}  // namespace gonio::reflectance
