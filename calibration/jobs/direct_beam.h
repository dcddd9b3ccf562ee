#pragma once

#include <vector>

#include "base/result.h"
#include "base/units.h"
#include "calibration/instrument_model.h"
#include "calibration/jobs/found_values.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// What stood in the beam's way, by its certificate.
struct Attenuator {
  Wavelength wavelength;
  Measured<double> passed;  ///< light passed / light, k = 1
};

/// The direct beam of each wavelength of a scan: straight through (theta_r = 180 deg - theta_i, phi_r = 180 deg) with
/// nothing on the stage, and at places beside it, where the beam must be whole on the detector, too. q is the mean of
/// all readings, weighted by their noise (photon transfer or scatter, monitor, reproducibility). Its u: that noise,
/// larger by chi-square over its degrees of freedom where that exceeds 1; the darks' errors, each visit's once; and, as
/// a rectangle, how far a place beside the beam lies off the middle beyond the noise of both.
/// Values, each wavelength: "direct_beam_q_<nm>nm" (per unit of the monitor), "direct_beam_attenuation_<nm>nm" (1), and
/// without uncertainty "direct_beam_dof_<nm>nm" (of u; 0: known), "direct_beam_net_<nm>nm" (DN),
/// "direct_beam_dlnq_dt0_<nm>nm" (1/s). Errors: IncompleteData (a wavelength without a reading of the middle or without
/// its attenuator; no light; a place beside the beam with 1 % less or more than its middle).
[[nodiscard]] Result<FoundValues> fit_direct_beam(const ScanReadings& scan, const InstrumentModel& instrument,
                                                  const std::vector<Attenuator>& attenuators);

/// What fit_direct_beam has found, as the model takes it; empty: `found` is of another job.
[[nodiscard]] std::vector<DirectBeam> direct_beams_of(const FoundValues& found);

}  // namespace gonio::calibration
