#include "drivers/drive_stage/drive_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "drivers/motion/move_task.h"

namespace gonio::drivers {

using stage::Axis;
using stage::DriveVerb;
using stage::Refusal;

namespace {

constexpr std::uint16_t kFollowingError = 1;  // protocol/stage: `axis_fault`
constexpr std::uint16_t kDriveFault = 2;
constexpr std::uint16_t kLimitSwitch = 3;

std::int64_t nearest(double value) {
  return std::llround(value);
}

DriveNumbers numbers_of(const StageConfig& config, Axis axis) {
  const AxisConfig& how = config.axis(axis);
  const stage::DriveAxis& drive = config.drives->axis(axis);
  const std::int64_t a = counts_of(config, axis, how.low);
  const std::int64_t b = counts_of(config, axis, how.high);
  return {.target = 0,
          .speed = nearest(how.speed / drive.speed_scale),
          .acceleration = nearest(how.acceleration / drive.acceleration_scale),
          .low_limit = std::min(a, b),
          .high_limit = std::max(a, b)};
}

Result<void> check_reach(const StageConfig& config, const MotionTarget& target) {
  for (const Axis axis : stage::kAllAxes) {
    const auto& wanted = target[stage::index_of(axis)];
    if (!wanted) continue;
    const AxisConfig& how = config.axis(axis);
    const std::optional<double> fixed = config.drives->axis(axis).fixed;
    const double low = fixed ? *fixed - how.window : how.low;
    const double high = fixed ? *fixed + how.window : how.high;
    if (*wanted >= low && *wanted <= high) continue;  // false for NaN too
    return failure({.code = ErrorCode::OutOfLimits,
                    .device = "stage",
                    .tried = motion_text(target),
                    .seen = fmt::format("{} target {:.3f} {}", stage::axis_name(axis), *wanted, stage::axis_unit(axis)),
                    .limit = fmt::format("{:.3f} to {:.3f} {}", low, high, stage::axis_unit(axis))});
  }
  return {};
}

}  // namespace

/// One axis with its drive, and what is remembered of it from look to look.
struct DriveStage::Drive {
  Drive(Axis the_axis, ModbusLink& link, const StageConfig& config, const Clock& clock)
      : axis(the_axis),
        line(link, clock, std::string(stage::axis_name(the_axis)), config.heartbeat_timeout),
        unit(line, *config.drives->map_of(the_axis)),
        numbers(numbers_of(config, the_axis)) {}

  Axis axis;
  UnitLine line;
  DriveUnit unit;
  DriveNumbers numbers;
  bool is_met = false;               ///< set up, and nothing since has spoken against it
  bool was_homed = false;            ///< at the last look, with no homing of ours after it
  bool is_checked = false;           ///< its boot_check is due at this look
  std::optional<std::int64_t> told;  ///< the last target
  std::optional<DriveLook> last;
  Instant last_at{};
  bool is_started = false;  ///< by the motion in hand
};

DriveStage::DriveStage(const DriveLinks& links, const StageConfig& config, DriveLatch& latch, const Clock& clock)
    : config_(config), latch_(latch), clock_(clock) {
  assert(config.drives);
  for (const Axis axis : stage::kAllAxes) {
    ModbusLink* link = links.axes[stage::index_of(axis)];
    if (link != nullptr) drives_[stage::index_of(axis)] = std::make_unique<Drive>(axis, *link, config, clock);
  }
  if (links.io == nullptr) return;
  io_line_ = std::make_unique<UnitLine>(*links.io, clock, "coupler", config.heartbeat_timeout);
  io_ = std::make_unique<IoCoupler>(*io_line_, *config.drives->io, clock, config.shutter_time / 2);
}

DriveStage::~DriveStage() = default;

// ---- looking ----

// What a drive holds is compared with what it is to hold before it is written: only then a loss of power shows.
Result<void> DriveStage::meet(Drive& drive) {
  const Result<bool> remembers = drive.unit.remembers(drive.numbers);
  if (!remembers) return failure(remembers.error());
  if (!*remembers) ++boot_counter_;
  GONIO_TRY(drive.unit.set_up(drive.numbers));
  drive.told.reset();
  drive.last.reset();
  drive.is_met = true;
  return {};
}

Result<void> DriveStage::check_power(Drive& drive, const DriveLook& look) {
  const bool has_lost_home = drive.was_homed && !look.homed;
  const bool is_due = std::exchange(drive.is_checked, false) || has_lost_home;
  if (!has_lost_home && !is_due) return {};
  const Result<bool> remembers = drive.unit.remembers(drive.numbers);
  if (!remembers) return failure(remembers.error());
  if (*remembers && !has_lost_home) return {};
  if (*remembers) ++boot_counter_;  // else `meet` counts it
  drive.is_met = false;
  return meet(drive);
}

// A position that the axis cannot have reached since the last look is asked for once more: two that agree are believed,
// one that does not repeat itself was somebody else's reply.
Result<std::int64_t> DriveStage::plausible(Drive& drive, std::int64_t counts) {
  if (!drive.last) return counts;
  constexpr double kSlack = 1.5;
  const AxisConfig& how = config_.axis(drive.axis);
  const double scale = std::abs(config_.drives->axis(drive.axis).scale);
  const auto is_near = [&](std::int64_t there, std::int64_t here, Instant since) {
    const double reach = (how.speed * in_seconds(clock_.now() - since) * kSlack + how.window) / scale + 1.0;
    return std::abs(static_cast<double>(there - here)) <= reach;
  };
  if (is_near(counts, drive.last->counts, drive.last_at)) return counts;
  const Instant first = clock_.now();
  const Result<std::int64_t> again = drive.unit.read_position();
  if (!again) return again;
  if (is_near(*again, drive.last->counts, drive.last_at) || is_near(*again, counts, first)) return again;
  return failure(drive.line.error(ErrorCode::BadReply, "read its position", fmt::format("{}, then {}", counts, *again),
                                  fmt::format("{} at the look before", drive.last->counts)));
}

Result<DriveLook> DriveStage::look_at(Drive& drive) {
  if (!drive.is_met) GONIO_TRY(meet(drive));
  Result<DriveLook> look = drive.unit.look();
  if (!look) return look;
  GONIO_TRY(check_power(drive, *look));
  const Result<std::int64_t> counts = plausible(drive, look->counts);
  if (!counts) return failure(counts.error());
  look->counts = *counts;
  drive.was_homed = look->homed;
  drive.last = *look;
  drive.last_at = clock_.now();
  return look;
}

void DriveStage::show(const Drive& drive, const DriveLook& look, StageState& state) const {
  AxisState& axis = state.axes[stage::index_of(drive.axis)];
  axis.counts = static_cast<std::int32_t>(look.counts);
  axis.position = position_of(config_, drive.axis, look.counts);
  axis.moving = look.moving;
  axis.homed = look.homed;
  axis.at_limit = look.at_limit;
  axis.alarm = look.alarm;
  if (look.fault && !look.tripped) {
    axis.fault = look.following_error ? kFollowingError : look.at_limit ? kLimitSwitch : kDriveFault;
    state.fault = axis.fault;
  }
  state.moving = state.moving || look.moving;
  state.homed = state.homed && look.homed;
  state.halted = state.halted || look.stopped;
  state.heartbeat_tripped = state.heartbeat_tripped || look.tripped;
}

void DriveStage::show_latch(StageState& state) const {
  const DriveLatch::Seen seen = latch_.seen();
  state.epoch = seen.epoch;
  state.halted = state.halted || seen.halted;
  state.stop_count = seen.stop_count;
  state.boot_counter = boot_counter_;
  state.accepted_token = accepted_token_;
  state.refused_token = refused_token_;
  state.refusal = refusal_;
}

Result<StageState> DriveStage::read_state() {
  StageState state;
  state.homed = true;
  next_checked_ = (next_checked_ + 1) % drives_.size();
  if (drives_[next_checked_]) drives_[next_checked_]->is_checked = true;
  for (const Axis axis : stage::kAllAxes) {
    Drive* drive = drives_[stage::index_of(axis)].get();
    if (drive == nullptr) {
      const double fixed = config_.drives->axis(axis).fixed.value_or(0.0);
      state.axes[stage::index_of(axis)] = {.position = fixed, .homed = true};
      continue;
    }
    const Result<DriveLook> look = look_at(*drive);
    if (!look) return failure(look.error());
    show(*drive, *look, state);
  }
  state.source_shutter = state.detector_shutter = stage::ShutterState::Open;
  state.monitor = 1.0;
  if (io_) GONIO_TRY(io_->look(state));
  show_latch(state);
  state.at = clock_.now();
  last_ = state;
  return state;
}

// ---- moving ----

MotionToken DriveStage::fresh_token() {
  if (++token_ == 0) ++token_;
  return token_;
}

MotionToken DriveStage::refuse(MotionToken token, Refusal refusal) {
  refused_token_ = token;
  refusal_ = refusal;
  return token;
}

// What the stage's own controller would refuse, in its order; `target` is none for homing.
Result<Refusal> DriveStage::judge(Epoch epoch, const MotionTarget* target) {
  if (!last_) {
    if (const auto seen = read_state(); !seen) return failure(seen.error());
  }
  const DriveLatch::Seen latch = latch_.seen();
  if (epoch < latch.epoch) return Refusal::EpochTooOld;
  if (latch.halted || last_->halted) return Refusal::Halted;
  if (last_->heartbeat_tripped) return Refusal::HeartbeatTripped;
  if (last_->interlock_open) return Refusal::InterlockOpen;
  if (last_->fault != 0) return Refusal::Fault;
  if (last_->moving) return Refusal::AlreadyMoving;
  if (target == nullptr) return Refusal::None;
  for (const Axis axis : stage::kAllAxes) {
    const std::size_t a = stage::index_of(axis);
    if ((*target)[a] && !last_->axes[a].homed) return Refusal::NotHomed;
  }
  return Refusal::None;
}

bool DriveStage::is_there(const Drive& drive, double target) const {
  const AxisState& axis = last_->axes[stage::index_of(drive.axis)];
  return drive.told && *drive.told == counts_of(config_, drive.axis, target) && !axis.moving &&
         std::abs(axis.position - target) <= 0.5 * config_.axis(drive.axis).window;
}

// All axes are prepared before the first is started, so that they start as close to each other as the line allows.
Result<void> DriveStage::tell_move(const MotionTarget& target, Epoch epoch) {
  for (const auto& drive : drives_) {
    if (!drive) continue;
    drive->is_started = false;
    const auto& wanted = target[stage::index_of(drive->axis)];
    if (!wanted || is_there(*drive, *wanted)) continue;
    if (!latch_.may_move(epoch)) return {};
    drive->numbers.target = counts_of(config_, drive->axis, *wanted);
    drive->told.reset();
    if (!drive->last || !drive->last->enabled) GONIO_TRY(drive->unit.run(DriveVerb::Enable, drive->numbers));
    GONIO_TRY(drive->unit.run(DriveVerb::PrepareMove, drive->numbers));
    drive->is_started = true;
  }
  for (const auto& drive : drives_) {
    if (!drive || !drive->is_started) continue;
    if (!latch_.may_move(epoch)) return {};
    GONIO_TRY(drive->unit.run(DriveVerb::StartMove, drive->numbers));
    drive->told = drive->numbers.target;
  }
  return {};
}

Result<void> DriveStage::tell_home(Epoch epoch) {
  for (const auto& drive : drives_) {
    if (!drive) continue;
    drive->is_started = false;
    if (!latch_.may_move(epoch)) return {};
    drive->told.reset();
    drive->last.reset();  // counts begin anew at the zero
    drive->was_homed = false;
    drive->is_started = true;
    GONIO_TRY(drive->unit.run(DriveVerb::Enable, drive->numbers));
    GONIO_TRY(drive->unit.run(DriveVerb::Home, drive->numbers));
  }
  return {};
}

void DriveStage::halt_what_moves() {
  for (const auto& drive : drives_) {
    // A line that does not carry this carries the halt line's no more either; the drive's watchdog is left.
    if (drive && drive->is_started) (void)drive->unit.run(DriveVerb::Halt, drive->numbers);
  }
}

// A halt may have come between the look at the latch and the word that starts an axis: then its own quick stop may have
// been overtaken, and is said once more here.
Result<MotionToken> DriveStage::conclude(MotionToken token, Epoch epoch, Result<void> told) {
  if (told && latch_.may_move(epoch)) {
    latch_.end_motion();
    accepted_token_ = token;
    return token;
  }
  halt_what_moves();
  latch_.end_motion();
  last_.reset();
  if (!told) return failure(std::move(told).error());
  return refuse(token, Refusal::Halted);
}

Result<MotionToken> DriveStage::start_move(const MotionTarget& target, Epoch epoch) {
  GONIO_TRY(check_reach(config_, target));
  const Result<Refusal> refusal = judge(epoch, &target);
  if (!refusal) return failure(refusal.error());
  const MotionToken token = fresh_token();
  if (*refusal != Refusal::None) return refuse(token, *refusal);
  latch_.begin_motion();
  return conclude(token, epoch, tell_move(target, epoch));
}

Result<MotionToken> DriveStage::start_homing(Epoch epoch) {
  const Result<Refusal> refusal = judge(epoch, nullptr);
  if (!refusal) return failure(refusal.error());
  const MotionToken token = fresh_token();
  if (*refusal != Refusal::None) return refuse(token, *refusal);
  latch_.begin_motion();
  return conclude(token, epoch, tell_home(epoch));
}

// ---- the rest ----

Result<void> DriveStage::set_shutters(bool source_open, bool detector_open) {
  if (io_) return io_->set_shutters(source_open, detector_open);
  if (source_open && detector_open) return {};
  return failure({.code = ErrorCode::DeviceRefused,
                  .device = "stage",
                  .tried = "close a shutter",
                  .seen = "the instrument's file has no coupler",
                  .limit = {}});
}

Result<void> DriveStage::reset(Epoch epoch) {
  if (!latch_.reset(epoch)) {
    return failure({.code = ErrorCode::DeviceRefused,
                    .device = "stage",
                    .tried = fmt::format("reset with epoch {}", epoch),
                    .seen = "an older epoch than the halt's",
                    .limit = fmt::format("at least {}", latch_.seen().epoch)});
  }
  for (const auto& drive : drives_) {
    if (!drive) continue;
    const Result<DriveLook> look = drive->unit.look();
    if (!look) return failure(look.error());
    if (look->fault) GONIO_TRY(drive->unit.run(DriveVerb::FaultReset, drive->numbers));
    if (look->stopped) GONIO_TRY(drive->unit.run(DriveVerb::ClearStop, drive->numbers));
  }
  last_.reset();
  return {};
}

}  // namespace gonio::drivers
