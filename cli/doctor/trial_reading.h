#pragma once

#include <string>

#include "cli/doctor/finding.h"
#include "protocol/api/instrument_report.h"

namespace gonio::cli {

/// The body of one reading by hand, with or without light.
[[nodiscard]] std::string trial_reading_body(bool lit);
/// The body of a move to the reference, in the light of the first filter: there is a bright surface.
[[nodiscard]] std::string to_the_reference_body(const api::InstrumentReport& instrument);

/// Whether a reading behind a closed shutter is one.
[[nodiscard]] Finding check_dark_reading(const api::DetectorReading& dark);
/// Whether a reading with both shutters open is brighter by more than its noise, and not too bright.
[[nodiscard]] Finding check_lit_reading(const api::DetectorReading& lit, const api::DetectorReading& dark);

}  // namespace gonio::cli
