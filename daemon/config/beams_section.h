#pragma once

#include "base/toml_reader.h"
#include "calibration/instrument_model.h"

namespace gonio::daemon {

/// Reads [beams]: the round lit spot and the round field of view across their beams, and the radii of the targets.
/// Without it the field is taken to lie within the spot everywhere. Mistakes stay in the reader.
void read_beams(TomlReader& root, calibration::InstrumentModel& model);

}  // namespace gonio::daemon
