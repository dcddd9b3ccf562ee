#pragma once

#include <cstdint>
#include <vector>

#include "base/result.h"
#include "daemon/config/instrument.h"
#include "daemon/store/store_reader.h"

namespace gonio::daemon {

/// The points of a scan of which neither sample nor reference is decided, in the fastest order that the planner finds
/// for them: its own search, as when the scan was planned. Takes seconds for many points: not for the sequencer's
/// thread. Errors: of the store; those of parse_plan and measuring_order.
[[nodiscard]] Result<std::vector<std::int32_t>> fastest_rest(StoreReader& store, ScanId scan,
                                                             const Instrument& instrument);

}  // namespace gonio::daemon
