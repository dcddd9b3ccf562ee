#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/geometry.h"
#include "base/result.h"
#include "calibration/dark_history.h"
#include "calibration/instrument_model.h"
#include "calibration/normalised_reading.h"
#include "calibration/raw_reading.h"

namespace gonio::calibration {

/// One look into the source, beside it or straight through.
struct BeamReading {
  NormalisedReading read;
  double u = 0.0;    ///< of q, random: noise (photon transfer or scatter), monitor, reproducibility
  Geometry planned;  ///< the point that it is of
  /// Planned theta_r and phi_r, in thousandths of a degree: readings with the same one are repeats.
  std::pair<std::int64_t, std::int64_t> place;
};

using BeamReadings = std::map<std::int64_t, std::vector<BeamReading>>;  ///< by wavelength in pm

/// Whether the detector looks straight into the source there: within 0.001 deg.
[[nodiscard]] bool is_straight(const Geometry& planned);

/// All readings of the plan's points, each in the order of the scan. Errors: as normalise.
[[nodiscard]] Result<BeamReadings> beam_readings_of(const ScanReadings& scan, const InstrumentModel& instrument,
                                                    const DarkHistory& darks);

/// Of a result that each reading's q changes by its weight (d result / dq, as many as readings): what each dark visit's
/// error does to all readings that lean on it, and what the level may have done between two visits. The result's unit.
[[nodiscard]] double u_of_darks(std::span<const BeamReading> readings, std::span<const double> weights,
                                double u_drift_dn_per_s);

/// "568nm": the end of a value's name.
[[nodiscard]] std::string nm_text(Wavelength wavelength);

}  // namespace gonio::calibration
