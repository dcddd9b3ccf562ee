#pragma once

#include <optional>

#include "base/toml_reader.h"
#include "base/units.h"
#include "calibration/instrument_model.h"

namespace gonio::daemon {

/// Reads [absolute]: the round stop that bounds what the detector takes in, and its distance from the arms' centre.
/// The direct beam itself is found by a job (calibration/jobs). Without the section no scan is absolute. Mistakes stay
/// in the reader.
void read_absolute(TomlReader& root, calibration::InstrumentModel& model);

/// Of a filter's table: `attenuation` and `u_attenuation` (k = 1) of what stands with it; none: nothing does.
[[nodiscard]] std::optional<Measured<double>> read_attenuation(TomlReader& filter);

}  // namespace gonio::daemon
