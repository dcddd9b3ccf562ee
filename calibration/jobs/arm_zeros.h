#pragma once

#include "base/result.h"
#include "base/units.h"
#include "calibration/instrument_model.h"
#include "calibration/jobs/found_values.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

struct ArmZeroOptions {
  Angle u_mirror;  ///< of the mirror's normal against a sample's, each direction, k = 1
};

/// Zeros of the arms (true angle = encoder + zero) from a plane mirror in the sample's place, whose lobe was crossed
/// along theta_r at azimuth 180 deg and along phi_r at theta_r = theta_i, for each theta_i; and, where the heads
/// allowed it, along theta_r across the normal at theta_i = 0. The centre of a crossing is that of a parabola through
/// ln q. With e the mirror's lean in the plane of incidence (prior u_mirror) and n twice the one across it, towards
/// phi = 90 deg (open), the reflected direction 2 (m . s) m - s of the mirror's normal m has its peak, to first order,
/// at
///   theta_i > 0:  centre theta_r = theta_i + z_i - z_r - 2 e;   centre phi_r = 180 deg - z_phi - n / tan(theta_r)
///   theta_i = 0:  centre theta_r = -z_r - (z_i - 2 e) cos(phi_r) + n sin(phi_r)
/// Where the normal was not crossed, z_i and z_r start from what the instrument states (0 with u_zero; with half of
/// their difference, where that is beyond twice of what is stated): what the crossings leave open stays as uncertain as
/// that. Values: "zero_theta_i_deg", "zero_theta_r_deg", "zero_phi_r_deg" (deg) with their covariance; the note says
/// the lean across (n / 2, u) and whether u_mirror is belied by it. Errors: IncompleteData (fewer than three theta_i
/// with both crossings).
[[nodiscard]] Result<FoundValues> fit_arm_zeros(const ScanReadings& scan, const InstrumentModel& instrument,
                                                const ArmZeroOptions& options);

}  // namespace gonio::calibration
