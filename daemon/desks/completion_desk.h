#pragma once

#include <string>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/config/instrument.h"
#include "daemon/desks/reference_shelf.h"
#include "daemon/store/records.h"
#include "daemon/store/store_reader.h"

namespace gonio::daemon {

/// A new scan of just those points that an ended one lacks on the sample or on the reference, under its policy, with
/// today's certificate. The idempotency key names the scan and what completed it last: asked for twice, it is made
/// once.
/// Errors: NotFound; WrongState (it is not over, nothing is missing, another scan completes it already, or the
/// instrument is another than then); those of the shelf, ReferenceExpired, ReferenceOutOfReach.
[[nodiscard]] Result<NewScan> completion_of(StoreReader& store, ScanId scan, const Instrument& instrument,
                                            const ReferenceShelf& shelf, UtcTime today, const std::string& who);

}  // namespace gonio::daemon
