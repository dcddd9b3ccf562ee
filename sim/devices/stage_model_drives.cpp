// The stage as separate drives: each axis is told, watched and cleared by itself.
#include <algorithm>

#include "sim/devices/stage_model.h"

namespace gonio::sim {

using stage::Axis;

void StageModel::drive_to(Axis a, std::int64_t counts, const AxisDynamics& wanted, Instant now) {
  AxisModel& axis = axes_[stage::index_of(a)];
  ++moves_;
  ++motion_commands_;
  axis.move_to(axis.target_of_counts(counts), wanted, moves_, now);
  advance_to(now);
}

void StageModel::home_drive(Axis a, Instant now) {
  ++moves_;
  ++motion_commands_;
  axes_[stage::index_of(a)].home(moves_, now);
  advance_to(now);  // an axis that stands at its home already is homed at once
}

void StageModel::brake_drive(Axis a, Instant now) {
  axes_[stage::index_of(a)].brake(now);
}

void StageModel::watch_drive(Axis a, Duration timeout, Instant now) {
  DriveWatch& watch = drive_watches_[stage::index_of(a)];
  watch.timeout = timeout;
  watch.last_word = now;
}

void StageModel::feed_drive(Axis a, Instant now) {
  drive_watches_[stage::index_of(a)].last_word = now;
}

bool StageModel::clear_drive(Axis a, Instant now) {
  AxisModel& axis = axes_[stage::index_of(a)];
  axis.clear_fault();
  drive_watches_[stage::index_of(a)] = {drive_watches_[stage::index_of(a)].timeout, now, false};
  fault_ = 0;
  for (const AxisModel& other : axes_) {
    if (other.fault() != 0) fault_ = other.fault();
  }
  return axis.fault() == 0;
}

void StageModel::power_cycle_axis(Axis a, Instant now) {
  axes_[stage::index_of(a)].power_cycle(now);
  drive_watches_[stage::index_of(a)] = {};
}

std::optional<Instant> StageModel::drive_watch_due(Axis a) const {
  const DriveWatch& watch = drive_watches_[stage::index_of(a)];
  if (watch.timeout <= Duration::zero() || watch.is_tripped) return std::nullopt;
  return watch.last_word + watch.timeout;
}

void StageModel::trip_drives(Instant now) {
  for (const Axis a : stage::kAllAxes) {
    const auto due = drive_watch_due(a);
    if (!due || *due > now) continue;
    drive_watches_[stage::index_of(a)].is_tripped = true;
    axes_[stage::index_of(a)].brake(now);
  }
}

}  // namespace gonio::sim
