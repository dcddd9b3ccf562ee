#include "reflectance/batch/lane_terms.h"

#include <cmath>

#include "reflectance/batch/lane_loop.h"
#include "reflectance/batch/vector_math.h"

namespace gonio::reflectance {
namespace {

constexpr double kHalfWay = 0.5 * lane::kHalfPi;

// half_theta_difference: between elevations where both directions are low.
GONIO_LANE double half_tilt(double theta_i, double elevation_i, double theta, double elevation) {
  const double by_theta = theta_i - theta;
  const double by_elevation = elevation - elevation_i;
  return 0.5 * (lane::most(elevation_i, elevation) < kHalfWay ? by_elevation : by_theta);
}

}  // namespace

void fill(SeparationRows& rows, const Direction& i, const DirectionBlock& r, VectorUnit unit) {
  const double theta_i = i.theta().si();
  const double elevation_i = i.elevation().si();
  const double phi_i = i.phi().si();
  const double sin_i = i.sin_theta();
  SeparationRows* const __restrict out = &rows;
  const DirectionBlock* const in = &r;
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    const double tilt = lane::sine(half_tilt(theta_i, elevation_i, in->theta[k], in->elevation[k]));
    const double turn = lane::sine_of_half_turn(0.5 * (phi_i - in->phi[k]));
    out->tilt2[k] = tilt * tilt;
    out->turn2[k] = turn * turn;
    out->sines[k] = sin_i * in->sin_theta[k];
  });
}

void fill(SumRows& rows, const Direction& i, const DirectionBlock& r, VectorUnit unit) {
  const double theta_i = i.theta().si();
  const double elevation_i = i.elevation().si();
  const double phi_i = i.phi().si();
  const double sin_i = i.sin_theta();
  SumRows* const __restrict out = &rows;
  const DirectionBlock* const in = &r;
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    const double tilt = lane::sine(half_tilt(theta_i, elevation_i, in->theta[k], in->elevation[k]));
    const double rise = lane::sine(0.5 * (elevation_i + in->elevation[k]));
    const double facing = lane::cosine_of_half_turn(0.5 * (phi_i - in->phi[k]));
    out->tilt2[k] = tilt * tilt;
    out->rise2[k] = rise * rise;
    out->facing2[k] = facing * facing;
    out->sines[k] = sin_i * in->sin_theta[k];
  });
}

void fill_phase(Row& row, const HenyeyGreenstein& phase, const SeparationRows& t, const Direction& i,
                const DirectionBlock& r, VectorUnit unit) {
  const double g = phase.g();
  const double numerator = phase.numerator();
  const double offset = phase.offset();
  double* const __restrict out = row.data();
  if (g < 0.0) {
    const SeparationRows* const in = &t;
    for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
      const double q = offset - 4.0 * g * lane::least(1.0, in->tilt2[k] + in->sines[k] * in->turn2[k]);
      out[k] = numerator / (q * lane::root(q));
    });
    return;
  }
  SumRows sums;
  fill(sums, i, r, unit);
  const SumRows* const in = &sums;
  for_each_lane(unit, [=](std::size_t k) GONIO_INLINED {
    const double q = offset + 4.0 * g * lane::least(1.0, in->rise2[k] + in->sines[k] * in->facing2[k]);
    out[k] = numerator / (q * lane::root(q));
  });
}

}  // namespace gonio::reflectance
