#pragma once

#include <memory>
#include <string>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/config/instrument.h"
#include "drivers/links/tape/tape_writer.h"

namespace gonio::daemon {

/// Begins a tape, before the store is opened for writing: the tape says what the store held. Errors: TapeWriter's.
[[nodiscard]] Result<std::unique_ptr<drivers::TapeWriter>> start_recording(const std::string& tape_file,
                                                                           const std::string& store_file,
                                                                           const Instrument& instrument,
                                                                           const std::string& boot_id,
                                                                           const Clock& clock);

/// The number of the store's last event; 0 for one that is not there, less for one that cannot be read as it is.
[[nodiscard]] std::int64_t last_event_of(const std::string& store_file);

}  // namespace gonio::daemon
