#pragma once

#include "base/result.h"
#include "daemon/sequencer/command.h"
#include "protocol/api/instrument_report.h"
#include "protocol/api/requests.h"

namespace gonio::daemon {

/// What a client asks for as the sequencer's verb. Errors: OutOfLimits (a time that is none).
[[nodiscard]] Result<ReadDetector> reading_verb(const api::DetectorReadRequest& request);
/// A reading by hand as a client sees it.
[[nodiscard]] api::DetectorReading reading_report(const HandReading& reading);

}  // namespace gonio::daemon
