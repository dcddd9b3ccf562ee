#pragma once

#include <array>
#include <vector>

#include "base/geometry.h"
#include "base/result.h"
#include "base/units.h"
#include "calibration/geometry_factor.h"
#include "calibration/instrument_model.h"
#include "calibration/left_out.h"

namespace gonio::calibration {

/// The solid angle that the detector's stop takes in, seen from a lit spot of this radius at these directions, as a
/// point of the spot and a point of the stop see it on the average:
///   A / d^2 [1 - 2 (<a^2> + <p^2> - 4 <x^2>) / d^2],
/// a within the stop, p on the surface within the spot, x = p along the detector's direction; beyond the next order in
/// (size / d)^2. Of coaxial discs it is what Walsh's closed form (1958) gives. u by the stop's radius and distance.
[[nodiscard]] Measured<SolidAngle> detector_solid_angle(const AbsoluteModel& absolute, Length spot_radius,
                                                        const Geometry& g);

/// What makes f_r of a reading without any standard.
struct AbsoluteRatio {
  double dvalue_dq = 0.0;                ///< f_s = dvalue_dq q_s, sr^-1 per unit of q
  std::array<double, 3> sample_slope{};  ///< d ln (mu_i mu_r O) / d (theta_i, theta_r, phi_r): f_s is off by minus it
  bool is_mixed = false;
  std::vector<RelativeTerm> terms;  ///< beam's noise, attenuator, stop, spot and field
  double beam_net_dn = 0.0;         ///< of the direct beam's reading: what linearity depends on
  double beam_dlnq_dt0 = 0.0;
};

/// f = q_s / (q_i Omega_d) [pi a_spot^2 / (mu_i mu_r O)], q_i that of the direct beam without its attenuator: with the
/// spot inside the field O = pi a_spot^2 / mu_i, and this is q_s / (q_i Omega_d mu_r) (Nicodemus 1977; STARR).
/// Elsewhere it rests on both radii, and says so. Errors: IncompleteData (no absolute model, no direct beam at the
/// wavelength, spot and field are not stated, or a direction below the surface: the direct beam's own reading).
[[nodiscard]] Result<AbsoluteRatio> absolute_ratio(const Geometry& sample, Wavelength wavelength,
                                                   const InstrumentModel& instrument, const LeftOut& left_out = {});

}  // namespace gonio::calibration
