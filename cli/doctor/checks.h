#pragma once

#include <string>
#include <vector>

#include "cli/doctor/finding.h"
#include "protocol/api/instrument_report.h"
#include "protocol/api/reports.h"

namespace gonio::cli {

// Judgements on what the daemon reports: pure functions, in the order in which an operator would ask.

/// Whether daemon, devices and store are without error, and whether their versions are those of this program.
[[nodiscard]] std::vector<Finding> check_daemon(const api::StatusReport& status, const std::string& own_version);
/// Faults, latches, home, and whether sensors and monitor say something that can be.
[[nodiscard]] std::vector<Finding> check_stage(const api::StageReport& stage, const api::InstrumentReport& instrument);
/// Room on the store's disk, speeds and filters that can be used.
[[nodiscard]] std::vector<Finding> check_instrument(const api::InstrumentReport& instrument);
/// Whether there is a standard to measure against, and for how long yet. `today`: "2026-11-22".
[[nodiscard]] std::vector<Finding> check_references(const api::ReferenceList& references, const std::string& today);

/// One motion of one axis there and what it took; `took_s` from the request to its answer.
[[nodiscard]] Finding check_axis_move(const api::AxisLimits& axis, double from, double to, double arrived,
                                      double took_s);
/// A way that is worth trying from where the axis stands: small, inside of its limits, towards the longer side.
[[nodiscard]] double trial_target(const api::AxisLimits& axis, double standing);
/// The time of a way by a trapezoid of speed, with settling, s.
[[nodiscard]] double told_time_s(const api::AxisLimits& axis, double way);

}  // namespace gonio::cli
