#include "reflectance/integral/polar_nodes.h"

#include "reflectance/batch/lane_loop.h"
#include "reflectance/batch/vector_math.h"

namespace gonio::reflectance {
namespace {

constexpr double kPi = 2.0 * lane::kHalfPi;

struct Angles {
  double upper;  ///< whose tangent is up/across
  double lower;  ///< what it lacks to 90 deg
};

// Both to full relative precision, up and across >= 0, not both 0.
GONIO_LANE Angles angles_of(double up, double across) {
  const double small = lane::small_angle(lane::least(up, across), lane::most(up, across));
  const double large = lane::complement(small);
  return up < across ? Angles{.upper = small, .lower = large} : Angles{.upper = large, .lower = small};
}

// In (-pi, pi].
GONIO_LANE double wrapped_once(double phi) {
  const double below = phi > kPi ? phi - 2.0 * kPi : phi;
  return below > -kPi ? below : below + 2.0 * kPi;
}

}  // namespace

void place(DirectionBlock& directions, DirectionBlock::Row& share, const PolarNodes& nodes, const Direction& axis,
           Angle origin, VectorUnit unit) {
  const double axis_mu = axis.mu();
  const double axis_sin = axis.sin_theta();
  const double origin_phi = origin.si();
  const PolarNodes* const in = &nodes;
  DirectionBlock* const __restrict out = &directions;
  double* const __restrict shares = share.data();
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    const double sin_xi = lane::sine_of_half_turn(in->xi[k]);
    const double cos_xi = lane::sine(lane::complement(in->xi[k]));
    const double mu = in->rise[k] * lane::sine_of_half_turn(in->left[k]);
    const double forward = cos_xi * axis_sin - sin_xi * in->cos_psi[k] * axis_mu;
    const double aside = sin_xi * in->sin_psi[k];
    const double sin_theta = lane::root(forward * forward + aside * aside);
    const Angles tilt = angles_of(mu, sin_theta);
    const double turn = angles_of(lane::magnitude(aside), lane::magnitude(forward) + 0x1p-1000).upper;
    const double folded = forward < 0.0 ? kPi - turn : turn;
    out->mu[k] = mu;
    out->sin_theta[k] = sin_theta;
    out->theta[k] = tilt.lower;
    out->elevation[k] = tilt.upper;
    out->phi[k] = wrapped_once(origin_phi + (aside < 0.0 ? -folded : folded));
    shares[k] = mu * sin_xi;
  });
}

}  // namespace gonio::reflectance
