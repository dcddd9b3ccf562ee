#pragma once

#include <string>

#include "daemon/config/instrument.h"
#include "protocol/api/instrument_report.h"

namespace gonio::daemon {

/// What the daemon was told of its instrument, in the words of the API, with what is free on the disk of `store_file`.
[[nodiscard]] api::InstrumentReport instrument_report(const Instrument& instrument, const std::string& store_file);

}  // namespace gonio::daemon
