#pragma once

#include <vector>

#include "base/units.h"

namespace gonio::api {

/// One ring of directions, and its part in an integral over them.
struct GaussRing {
  Angle theta;
  double weight = 0.0;
};

/// `count` rings in (0, to), nearest the normal first, so that
///   sum of weight * (mean of f over the ring) = integral of f cos(theta) dOmega over theta < to,
/// exactly where the mean of f over phi is a polynomial of degree below 2 count in cos^2(theta): the nodes and weights
/// of Gauss and Legendre in u = cos^2(theta) over [cos^2(to), 1], each weight times pi (1 - cos^2(to)) / 2, since
/// cos(theta) sin(theta) dtheta = -du / 2. The weights sum to pi sin^2(to). `to` in (0, 90 deg]. Nodes by Newton's
/// method on the recurrence of P_n (Abramowitz and Stegun 1964, 22.7.10, 25.4.30).
[[nodiscard]] std::vector<GaussRing> gauss_rings(int count, Angle to);

}  // namespace gonio::api
