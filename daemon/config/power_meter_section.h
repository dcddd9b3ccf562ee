#pragma once

#include "base/toml_reader.h"
#include "daemon/config/instrument.h"

namespace gonio::daemon {

/// [detector] of kind "usbtmc", with its [detector.model]. Errors stick in the reader.
void read_power_detector(TomlReader& table, Instrument& instrument);

/// [monitor], if there is one: kind "stage" (the stage's own, gated by the camera's exposure) or "usbtmc". A detector
/// that gates nothing needs the latter. Errors stick in the reader.
void read_monitor(TomlReader& root, Instrument& instrument);

}  // namespace gonio::daemon
