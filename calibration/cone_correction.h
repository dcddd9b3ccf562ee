#pragma once

#include "calibration/direction_slopes.h"
#include "calibration/instrument_model.h"
#include "calibration/point_equation.h"
#include "calibration/term_list.h"

namespace gonio::calibration {

/// What the cones of source and detector add to f_s, and how well that is known; sr^-1.
///
/// A reading is the mean of f weighted with mu over an evenly filled cap of directions about each arm. The mean of any
/// smooth g over a cap of half angle a is g + kappa Delta g + O(a^4), kappa = (1 - cos a) / 4 (a^2 / 8; exact for
/// spherical harmonics of order 1, by Funk's and Hecke's theorem), Delta the Laplacian on the sphere. With g = f mu
/// over the mean of mu, Delta mu = -2 mu and grad mu = -sin(theta) along theta:
///   <f mu> / <mu> = f + kappa (Delta f - 2 tan(theta) f_theta),
///   Delta f = f_thetatheta + cot(theta) f_theta + f_phiphi / sin^2(theta),
/// for the source's direction and for the detector's, their sum to this order. At the pole Delta f is twice the second
/// derivative along one line, with as much uncertainty as that line. Where no points say how f bends with phi, Delta f
/// is f_thetatheta, and the bend across it an uncertainty of the same size.
/// The reference has the same bias, from its shape table, and keeps its part of it in f_s:
///   f_s = f_measured (1 + beta_ref) - B_s.
struct ConeCorrection {
  double bias = 0.0;            ///< B_s - f beta_ref: to be subtracted
  double sample_bias = 0.0;     ///< B_s
  double u_unresolved = 0.0;    ///< of the curvature that the points do not resolve, and of the next order, B^2 / f
  double u_noise = 0.0;         ///< of the second differences
  double per_source_u = 0.0;    ///< of the source's half angle: per standard deviation
  double per_detector_u = 0.0;  ///< of the detector's
  bool is_limited = false;      ///< the correction and what is unresolved of it pass 10 % of f
};

/// Nothing of it without stated cones.
[[nodiscard]] ConeCorrection cone_correction(const PairedPoint& point, const DirectionSlopes& slopes,
                                             const InstrumentModel& instrument, const ReferenceStandard& standard);

void add_cone_terms(const ConeCorrection& correction, const InstrumentModel& instrument, TermList& terms);

}  // namespace gonio::calibration
