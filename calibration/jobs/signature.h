#pragma once

#include "base/result.h"
#include "calibration/instrument_model.h"
#include "calibration/jobs/found_values.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// The instrument's signature: the detector scanned through the direct beam with nothing on the stage, in the plane of
/// incidence (theta_r) and across it (phi_r). Angles are those at the stage's centre from straight through (theta_r =
/// 180 deg - theta_i, phi_r = phi_i + 180 deg): across, phi_r times sin(theta_r). Readings of one place are one: they
/// may have been made without a move between, and then have one error of pointing.
/// Values, each wavelength: "signature_width_plane_<nm>nm" and "signature_width_across_<nm>nm" (deg, full widths at
/// half maximum as of crossings through the beam's middle), "signature_centre_plane_<nm>nm" and
/// "signature_centre_across_<nm>nm" (deg, by the encoders, towards greater theta_r and phi_r); and, where the model
/// states the detector's stop and the crossings are those of an even round beam, "signature_beam_radius_<nm>nm" (mm, at
/// the stop: even_beam.h), its u widened by chi-square. u: crossing_width.h, even_beam.h, and the darks' errors. The
/// covariance is diagonal: what widths and radius share is not told. The note says chi-square, why a radius is missing,
/// and how all that compares with [beams] and the stated cones.
/// Errors: IncompleteData (no readings; those of crossing_width, with the wavelength and the crossing).
[[nodiscard]] Result<FoundValues> fit_signature(const ScanReadings& scan, const InstrumentModel& instrument);

}  // namespace gonio::calibration
