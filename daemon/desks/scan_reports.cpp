#include "daemon/desks/scan_reports.h"

#include <algorithm>

namespace gonio::daemon {
namespace {

api::TimeSplit divided(const api::TimeSplit& split, double n) {
  const api::IdleSplit& idle = split.idle_by;
  return {.move_s = split.move_s / n,
          .settle_s = split.settle_s / n,
          .expose_s = split.expose_s / n,
          .read_s = split.read_s / n,
          .idle_s = split.idle_s / n,
          .idle_by = {.commit_s = idle.commit_s / n,
                      .wire_s = idle.wire_s / n,
                      .device_s = idle.device_s / n,
                      .hold_s = idle.hold_s / n,
                      .planning_s = idle.planning_s / n}};
}

// A point is measured when all of its items are.
api::TimeSplit seconds_a_point(const api::TimeSplit& spent, std::int64_t accepted, api::ReferenceMode mode) {
  const double points = static_cast<double>(accepted) / static_cast<double>(items_of(1, mode));
  return points < 1.0 ? api::TimeSplit{} : divided(spent, points);
}

std::vector<api::HoldReport> hold_reports(const std::vector<Hold>& holds, Instant now) {
  std::vector<api::HoldReport> reports;
  for (const Hold& hold : holds) {
    reports.push_back({.name = std::string(hold_name(hold.name)),
                       .owner = hold.owner,
                       .reason = hold.reason,
                       .age_s = in_seconds(now - hold.since)});
  }
  return reports;
}

std::string shutter_word(stage::ShutterState state) {
  if (state == stage::ShutterState::Moving) return "moving";
  return state == stage::ShutterState::Open ? "open" : "closed";
}

}  // namespace

api::TimeSplit time_split(const TimeParts& parts) {
  return {.move_s = in_seconds(parts.move),
          .settle_s = in_seconds(parts.settle),
          .expose_s = in_seconds(parts.expose),
          .read_s = in_seconds(parts.read),
          .idle_s = in_seconds(parts.idle.total()),
          .idle_by = {.commit_s = in_seconds(parts.idle.commit),
                      .wire_s = in_seconds(parts.idle.wire),
                      .device_s = in_seconds(parts.idle.device),
                      .hold_s = in_seconds(parts.idle.hold),
                      .planning_s = in_seconds(parts.idle.planning)}};
}

api::ScanReport scan_report(const ScanInfo& info, Instant now) {
  api::ScanReport report;
  report.id = info.id;
  report.name = info.name;
  report.campaign = info.campaign;
  report.sample = info.sample;
  report.isotropic = info.isotropic;
  report.state = scan_state_name(info.state);
  report.outcome = info.outcome;
  report.who = info.who;
  report.reference = info.reference_serial;
  report.instrument_sha256 = info.instrument_hash;
  report.submitted_utc = iso8601(info.submitted);
  report.changed_utc = iso8601(info.changed);
  report.points = info.counts.points;
  report.merged = info.counts.merged;
  report.blocked = info.counts.blocked;
  report.items = info.counts.items;
  report.accepted = info.counts.accepted;
  report.skipped = info.counts.skipped;
  report.attempts = info.counts.attempts;
  report.visits = info.counts.visits;
  report.reference_visits = info.counts.reference_visits;
  report.check_visits = info.counts.check_visits;
  report.measured_again = info.counts.reopened;
  report.largest_drift = info.largest_drift;
  report.spent = time_split(info.spent);
  report.seconds_a_point = seconds_a_point(report.spent, report.accepted, info.policy.reference_mode);
  report.holds = hold_reports(info.holds, now);
  report.priority = info.turn.priority;
  report.preempts = info.turn.preempts;
  if (info.turn.start) report.start_utc = iso8601(info.turn.start->utc);
  report.completes = info.turn.completes;
  report.completed_by = info.completed_by;
  return report;
}

api::WarmUpReport warm_up_report(const WarmUpProgress& progress) {
  constexpr double kPercentPerMinute = 6000.0;
  api::WarmUpReport report{.slope_percent_per_min = std::nullopt,
                           .limit_percent_per_min = kPercentPerMinute * progress.limit_per_s,
                           .waited_s = in_seconds(progress.waited),
                           .at_least_s = in_seconds(progress.at_least),
                           .at_most_s = in_seconds(progress.at_most)};
  if (progress.slope_per_s) report.slope_percent_per_min = kPercentPerMinute * *progress.slope_per_s;
  return report;
}

void add_progress(api::ScanReport& report, const SequencerStatus& status, Instant now) {
  const std::optional<ScanState> state = scan_state_from_name(report.state);
  if (!state || is_over(*state)) return;  // the store knows first
  const auto place = std::find(status.queued.begin(), status.queued.end(), report.id);
  if (place != status.queued.end()) report.queue_place = 1 + (place - status.queued.begin());
  if (!status.active || status.active->scan != report.id) return;
  const Progress& progress = *status.active;
  report.doing = status.doing;
  report.holds = hold_reports(progress.holds, now);
  report.learned_from_scans = progress.learned_from;
  if (!progress.remaining) return;
  report.remaining_s = in_seconds(*progress.remaining);
  report.u_remaining_s = in_seconds(progress.u_remaining);
}

api::StageReport stage_report(const drivers::StageState& state, Instant now) {
  api::StageReport report{.age_s = in_seconds(now - state.at),
                          .moving = state.moving,
                          .homed = state.homed,
                          .halted = state.halted,
                          .heartbeat_tripped = state.heartbeat_tripped,
                          .interlock_open = state.interlock_open,
                          .fault = state.fault,
                          .epoch = state.epoch,
                          .boot_counter = state.boot_counter,
                          .source_shutter = shutter_word(state.source_shutter),
                          .detector_shutter = shutter_word(state.detector_shutter),
                          .monitor = state.monitor,
                          .lamp_temperature_c = state.lamp_temperature_c,
                          .detector_temperature_c = state.detector_temperature_c,
                          .room_temperature_c = state.room_temperature_c,
                          .humidity_percent = state.humidity_percent,
                          .axes = {}};
  for (const stage::Axis axis : stage::kAllAxes) {
    const drivers::AxisState& one = state.axes[stage::index_of(axis)];
    report.axes.push_back({.name = std::string(stage::axis_name(axis)),
                           .unit = std::string(stage::axis_unit(axis)),
                           .position = one.position,
                           .moving = one.moving,
                           .homed = one.homed,
                           .at_limit = one.at_limit,
                           .fault = one.fault});
  }
  return report;
}

api::PointReport point_report(const PointInfo& info) {
  const Geometry& g = info.point.geometry;
  return {.index = info.point.index,
          .rank = info.point.rank,
          .theta_i_deg = in_degrees(g.theta_i),
          .phi_i_deg = in_degrees(g.phi_i),
          .theta_r_deg = in_degrees(g.theta_r),
          .phi_r_deg = in_degrees(g.phi_r),
          .wavelength_nm = in_nanometres(info.point.wavelength),
          .blocked = info.point.blocked,
          .sample = info.sample_outcome,
          .reference = info.reference_outcome,
          .attempts = info.attempts};
}

api::Event event_report(const EventRecord& event) {
  return {.number = event.number,
          .kind = event.kind,
          .kind_version = event.kind_version,
          .scan = event.scan,
          .who = event.who,
          .utc = iso8601(event.utc),
          .data = event.json};
}

}  // namespace gonio::daemon
