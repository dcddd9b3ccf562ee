#pragma once

#include <cstdint>
#include <optional>

#include "base/result.h"
#include "daemon/store/store_reader.h"
#include "protocol/api/scan_review.h"

namespace gonio::daemon {

/// The self-checks of what a scan has so far, by the texts it was accepted with. A failed one changes nothing.
/// Errors: those of compute_brdf.
[[nodiscard]] Result<api::ScanChecksReport> checks_of(StoreReader& reader, ScanId scan);

/// The budget of a point, its terms by their share; without one that of the point whose U / |f| is the median.
/// Errors: those of compute_brdf; NotFound (no such point), IncompleteData (it has no value; why).
[[nodiscard]] Result<api::PointBudgetReport> budget_of_point(StoreReader& reader, ScanId scan,
                                                             std::optional<std::int64_t> point);

}  // namespace gonio::daemon
