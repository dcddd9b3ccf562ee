#pragma once

#include <cstdint>
#include <vector>

#include "daemon/store/database.h"
#include "daemon/store/records.h"

namespace gonio::daemon {

/// All scans that are not over, oldest first. Holds' times are carried into this boot by UTC. Errors stick in the
/// database.
[[nodiscard]] std::vector<UnfinishedScan> read_unfinished(Database& database, Instant now, UtcTime utc_now);

/// The points of a scan with index > `after`, by index.
[[nodiscard]] std::vector<ScanPoint> read_points(Database& database, ScanId scan, std::int32_t after,
                                                 std::int64_t at_most);
/// Holds in force.
[[nodiscard]] std::vector<Hold> read_holds(Database& database, ScanId scan, Instant now, UtcTime utc_now);
/// Its place in the queue, the start carried into this boot by UTC.
[[nodiscard]] ScanTurn read_turn(Database& database, ScanId scan, Instant now, UtcTime utc_now);
/// The sum over all attempts and visits.
[[nodiscard]] TimeParts read_time_spent(Database& database, ScanId scan);
/// The largest relative change between two lit visits of one kind; 0 without.
[[nodiscard]] double read_largest_drift(Database& database, ScanId scan);
/// The policy in columns `first` and after: target_snr, max_time_ns, exposures_ns, block_ns, dark_every_ns,
/// item_retries, on_item_error, on_restart, reference_every_ns, check_every_ns, drift_limit, drift_rounds,
/// reference_mode, anchor_theta_i_deg, anchor_theta_r_deg, anchor_phi_r_deg.
[[nodiscard]] ScanPolicy policy_from_row(const Statement& row, int first);

}  // namespace gonio::daemon
