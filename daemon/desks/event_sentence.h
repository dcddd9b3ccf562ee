#pragma once

#include <string>

#include "daemon/store/records.h"

namespace gonio::daemon {

/// An event as the log has it: "scan 3: hold added by local (hold lamp, owner monitor, reason 0.1 is below 0.2)".
[[nodiscard]] std::string event_sentence(const EventRecord& event);

}  // namespace gonio::daemon
