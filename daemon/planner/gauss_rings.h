#pragma once

#include <vector>

#include "base/units.h"

namespace gonio::daemon {

/// One ring of directions, and its part in an integral over them.
struct GaussRing {
  Angle theta;
  double weight = 0.0;
};

/// `count` rings in (0, to), nearest the normal first, so that
///   sum of weight * (mean of f over the ring) = integral of f cos(theta) dOmega over theta < to,
/// exactly where the mean of f over phi is a polynomial of degree below 2 count in cos^2(theta): the nodes and weights
/// of Gauss and Legendre in t = sin^2(theta) / sin^2(to) over [0, 1], each weight times pi sin^2(to), since
/// cos(theta) sin(theta) dtheta = dt sin^2(to) / 2. The weights sum to pi sin^2(to). `to` in (0, 90 deg].
[[nodiscard]] std::vector<GaussRing> gauss_rings(int count, Angle to);

}  // namespace gonio::daemon
