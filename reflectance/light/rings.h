#pragma once

#include <vector>

#include "reflectance/light/sky.h"
#include "reflectance/light/sun_disk.h"

namespace gonio::reflectance {

/// A ring of the sky, or the arc of one that lies in a disk.
struct Ring {
  Direction at;             ///< at the azimuth 0, or that of the disk's centre
  double half_width = 0.0;  ///< [rad] of azimuth to either side: pi all around
  double weight_sr = 0.0;   ///< mu dOmega of the ring, all of its azimuths
};

/// An azimuth of a ring and its share of it; shares sum to 1.
struct AzimuthNode {
  Angle phi;
  double share = 0.0;
};

/// Rings over the whole hemisphere, their weights summing to pi, `level` 0 to 6: pieces between the sky's thetas of
/// kinks, Gaussian (in the square root of the elevation from the horizon on), double-exponential towards a peak.
[[nodiscard]] std::vector<Ring> sky_rings(const Sky& sky, int level);
/// Azimuths all around: evenly spaced; between the sky's azimuths of kinks; or closing in on its peak.
[[nodiscard]] std::vector<AzimuthNode> sky_azimuths(const Sky& sky, int level);
/// The arcs that the disk cuts from the rings of the sky, `level` 0 to 6: their widths in closed form, the sharp ends
/// of the disk taken up by the rule.
[[nodiscard]] std::vector<Ring> disk_rings(const SunDisk& disk, int level);

}  // namespace gonio::reflectance
