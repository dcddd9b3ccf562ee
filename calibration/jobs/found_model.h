#pragma once

#include "base/result.h"
#include "calibration/instrument_model.h"
#include "calibration/jobs/found_values.h"

namespace gonio::calibration {

/// The model with these values in the place of what was stated, covariance included: "linearity_1" and on with
/// "exposure_offset_s"; "zero_theta_i_deg", "zero_theta_r_deg", "zero_phi_r_deg"; the direct beams of
/// direct_beam.h, where the model states the detector's stop. What a linearity leaves, `u_linearity`, becomes 0: its
/// covariance stands for it. Names that no model has are passed over. Errors:
/// IncompleteData (a covariance of another size than the values).
[[nodiscard]] Result<InstrumentModel> with_found(InstrumentModel model, const FoundValues& found);

}  // namespace gonio::calibration
