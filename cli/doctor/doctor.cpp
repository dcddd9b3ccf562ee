#include "cli/doctor/doctor.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "cli/doctor/checks.h"
#include "cli/doctor/trial_move.h"
#include "cli/doctor/trial_reading.h"

namespace gonio::cli {
namespace {

using api::RouteId;
using SteadyClock = std::chrono::steady_clock;

constexpr std::string_view kDetectorArm = "theta_r";
constexpr double kFirstLook_s = 5.0;

double seconds_since(SteadyClock::time_point start) {
  return std::chrono::duration<double>(SteadyClock::now() - start).count();
}

Finding failed(std::string check, const Error& error) {
  return {.check = std::move(check),
          .verdict = Verdict::Failed,
          .seen = describe(error),
          .remedy = std::string(traits(error.code).remedy)};
}

}  // namespace

Doctor::Doctor(DaemonClient& client, OpenAnother open_another, DoctorOptions options, Tell tell)
    : client_(client), open_another_(std::move(open_another)), options_(std::move(options)), tell_(std::move(tell)) {}

void Doctor::note(const Finding& finding) {
  has_failed_ = has_failed_ || finding.verdict == Verdict::Failed;
  tell_(finding);
}

void Doctor::note_all(const std::vector<Finding>& findings) {
  for (const Finding& finding : findings) note(finding);
}

void Doctor::skip(const std::string& check, const std::string& why) {
  note({.check = check, .verdict = Verdict::Skipped, .seen = why});
}

Result<bool> Doctor::run() {
  GONIO_TRY(look());
  if (options_.move) {
    try_motion();
  } else {
    skip("motion", "asked for with --move: each axis goes a little and back, the detector reads, and one STOP");
  }
  return !has_failed_;
}

// A daemon that has just been started has not seen its stage yet: bounded.
Result<api::StatusReport> Doctor::status_with_stage() {
  const auto started = SteadyClock::now();
  while (true) {
    auto status = client_.get<api::StatusReport>(RouteId::Status);
    if (!status) return failure(status.error());
    const bool says_something = status->value.stage || status->value.stage_error;
    if (says_something || seconds_since(started) > kFirstLook_s) return std::move(status->value);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

Result<void> Doctor::look() {
  const Result<api::StatusReport> status = status_with_stage();
  if (!status) return failure(status.error());
  const auto instrument = client_.get<api::InstrumentReport>(RouteId::Instrument);
  if (!instrument) return failure(instrument.error());
  const auto references = client_.get<api::ReferenceList>(RouteId::References);
  if (!references) return failure(references.error());
  instrument_ = instrument->value;
  note_all(check_daemon(*status, options_.own_version));
  note_all(check_instrument(instrument_));
  note_all(check_references(references->value, options_.today));
  if (status->stage) {
    const std::vector<Finding> stage = check_stage(*status->stage, instrument_);
    note_all(stage);
    may_move_ = stage.front().verdict != Verdict::Failed && !status->stage_error;
  } else {
    skip("stage", "it has not answered");
  }
  return {};
}

void Doctor::try_motion() {
  if (!may_move_) return skip("motion", "the stage is not free to move");
  if (const auto homed = client_.post<api::CommandReport>(RouteId::StageHome, 0, "{}"); !homed) {
    return note(failed("homing", homed.error()));
  }
  note({.check = "homing", .seen = "all axes found their home"});
  // With the detector's arm out of the way nothing stands in the shadow, where home often is.
  for (const api::AxisLimits& axis : instrument_.axes) {
    if (axis.name == kDetectorArm) (void)try_way(axis, 0.5 * (axis.low + axis.high));
  }
  try_readings();
  for (const api::AxisLimits& axis : instrument_.axes) {
    if (axis.name != kDetectorArm) try_axis(axis);
  }
  try_stop();
}

// Of the reference, which is bright from every side. The shutters are put back by the daemon.
void Doctor::try_readings() {
  const std::string check = "detector reads";
  const auto moved = client_.post<api::CommandReport>(RouteId::StageMove, 0, to_the_reference_body(instrument_));
  if (!moved) return note(failed(check, moved.error()));
  const auto dark = client_.post<api::DetectorReading>(RouteId::DetectorRead, 0, trial_reading_body(false));
  if (!dark) return note(failed(check, dark.error()));
  note(check_dark_reading(dark->value));
  const auto lit = client_.post<api::DetectorReading>(RouteId::DetectorRead, 0, trial_reading_body(true));
  if (!lit) return note(failed(check, lit.error()));
  note(check_lit_reading(lit->value, dark->value));
}

Result<double> Doctor::position(const std::string& axis) {
  const auto stage = client_.get<api::StageReport>(RouteId::Stage);
  if (!stage) return failure(stage.error());
  for (const api::AxisReport& seen : stage->value.axes) {
    if (seen.name == axis) return seen.position;
  }
  return failure(
      {.code = ErrorCode::BadReply, .device = "daemon", .tried = "read where " + axis + " is", .seen = "no such axis"});
}

Result<double> Doctor::move(const api::AxisLimits& axis, double to) {
  const auto started = SteadyClock::now();
  const auto moved = client_.post<api::CommandReport>(RouteId::StageMove, 0, trial_move_body(axis.name, to));
  if (!moved) return failure(moved.error());
  return seconds_since(started);
}

bool Doctor::try_way(const api::AxisLimits& axis, double to) {
  const std::string check = "axis " + axis.name + " moves";
  const Result<double> from = position(axis.name);
  const Result<double> took = from ? move(axis, to) : failure(from.error());
  const Result<double> arrived = took ? position(axis.name) : failure(took.error());
  if (arrived) {
    note(check_axis_move(axis, *from, to, *arrived, *took));
  } else if (arrived.error().code == ErrorCode::Blocked) {
    skip(check, describe(arrived.error()));
  } else {
    note(failed(check, arrived.error()));
  }
  return arrived.has_value();
}

// There and back: the way back shows slack, and leaves the axis as it was found.
void Doctor::try_axis(const api::AxisLimits& axis) {
  const Result<double> standing = position(axis.name);
  if (!standing) return note(failed("axis " + axis.name + " moves", standing.error()));
  const double home = std::clamp(*standing, axis.low, axis.high);
  if (try_way(axis, trial_target(axis, home))) (void)try_way(axis, home);
}

// The daemon shows where the axis is while it moves; bounded, for a move that was refused.
void Doctor::wait_until_underway(const api::AxisLimits& axis, double standing, double at_most_s) {
  const auto started = SteadyClock::now();
  while (seconds_since(started) < at_most_s) {
    const Result<double> seen = position(axis.name);
    if (seen && std::abs(*seen - standing) > 10.0 * axis.window) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

// The axis with the longest way is sent across it and stopped underway: its move must not count as done.
void Doctor::try_stop() {
  const std::string check = "STOP halts a move";
  const auto slowest = std::ranges::max_element(
      instrument_.axes, {}, [](const api::AxisLimits& a) { return told_time_s(a, a.high - a.low); });
  Result<DaemonClient> second = open_another_();
  const Result<double> standing = position(slowest->name);
  if (!second || !standing) return note(failed(check, second ? standing.error() : second.error()));
  const double end = slowest->high - *standing > *standing - slowest->low ? slowest->high : slowest->low;
  std::optional<Error> ended_by;
  std::thread mover([&] {
    const auto moved = second->post<api::CommandReport>(RouteId::StageMove, 0, trial_move_body(slowest->name, end));
    if (!moved) ended_by = moved.error();
  });
  wait_until_underway(*slowest, *standing, 0.5 * told_time_s(*slowest, end - *standing));
  const auto asked = SteadyClock::now();
  const auto stopped = client_.post<api::StopReport>(RouteId::Stop, 0, "{}");
  const double took = seconds_since(asked);
  mover.join();
  if (!stopped) return note(failed(check, stopped.error()));
  const Result<double> stands = position(slowest->name);
  note(check_stop(slowest->name, end, stands ? *stands : end, took, ended_by));
  if (const auto reset = client_.post<api::CommandReport>(RouteId::StageReset, 0, "{}"); !reset) {
    note(failed("reset after STOP", reset.error()));
  }
}

}  // namespace gonio::cli
