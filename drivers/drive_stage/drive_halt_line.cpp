#include "drivers/drive_stage/drive_halt_line.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "drivers/links/gave_way.h"

namespace gonio::drivers {

using stage::Axis;
using stage::DriveVerb;

namespace {

constexpr std::int64_t kBeatMask = 0x7FFF;  // fits whatever the register's sign

constexpr int kOneTry = 1;  // halts are tried again in rounds over all drives, beats by the next beat

}  // namespace

struct DriveHaltLine::Drive {
  Drive(Axis axis, ModbusLink& halts, ModbusLink& the_beats, const StageConfig& config, const Clock& clock)
      : map(*config.drives->map_of(axis)),
        halt_line(halts, clock, std::string(stage::axis_name(axis)), config.heartbeat_timeout, kOneTry),
        beat_line(the_beats, clock, std::string(stage::axis_name(axis)), config.heartbeat_timeout, kOneTry),
        unit(halt_line, map),
        beats(the_beats) {}

  const stage::DriveMap& map;
  UnitLine halt_line;
  UnitLine beat_line;
  DriveUnit unit;
  ModbusLink& beats;
};

DriveHaltLine::DriveHaltLine(const DriveLinks& halts, const DriveLinks& beats, const StageConfig& config,
                             DriveLatch& latch, const Clock& clock)
    : latch_(latch) {
  for (const Axis axis : stage::kAllAxes) {
    const std::size_t a = stage::index_of(axis);
    if (halts.axes[a] == nullptr) continue;
    drives_.push_back(std::make_unique<Drive>(axis, *halts.axes[a], *beats.axes[a], config, clock));
  }
}

DriveHaltLine::~DriveHaltLine() = default;

Result<void> DriveHaltLine::halt(Epoch epoch) {
  latch_.halt(epoch);
  std::vector<Drive*> moving;
  for (const auto& drive : drives_) moving.push_back(drive.get());
  Result<void> outcome;
  for (int tries = 0; tries < kHaltTries && !moving.empty(); ++tries) {
    const bool was_starting = latch_.is_in_motion();
    outcome = {};
    std::vector<Drive*> again;
    for (Drive* drive : moving) {
      Result<void> told = drive->unit.run(DriveVerb::Halt, {});
      if (told) continue;
      again.push_back(drive);
      if (outcome) outcome = std::move(told);
    }
    moving = std::move(again);
    if (!was_starting || tries > 0) continue;
    // The word that starts an axis may have come after its quick stop: all once more.
    moving.clear();
    for (const auto& drive : drives_) moving.push_back(drive.get());
  }
  if (!outcome) outcome.error().tried = fmt::format("halt with epoch {} ({})", epoch, outcome.error().tried);
  return outcome;
}

Result<void> DriveHaltLine::watch_heartbeat(Duration timeout) {
  timeout_ = timeout;
  return {};
}

// False: somebody wants the line for a halt.
bool DriveHaltLine::take(ModbusLink* link) {
  const std::lock_guard lock(mutex_);
  in_use_ = link;
  return !is_interrupted_;
}

Result<void> DriveHaltLine::feed(Drive& drive) {
  const stage::Register* feed = drive.map.find("feed");
  const stage::Register* watchdog = drive.map.find("watchdog");
  if (feed != nullptr) GONIO_TRY(drive.beat_line.write(*feed, beats_ & kBeatMask, "feed its watchdog"));
  if (watchdog == nullptr) return {};
  const std::int64_t wanted = std::llround(std::ceil(in_seconds(timeout_) / drive.map.watchdog_s_per_count));
  const Result<std::int64_t> now = drive.beat_line.read(*watchdog, "read its watchdog");
  if (!now) return failure(now.error());
  if (*now == wanted) return {};
  return drive.beat_line.write(*watchdog, wanted, fmt::format("set its watchdog to {}", wanted));
}

Result<void> DriveHaltLine::beat() {
  ++beats_;
  Result<void> outcome;
  for (const auto& drive : drives_) {
    if (!take(&drive->beats)) {
      outcome = failure(drive->beat_line.error(ErrorCode::Unreachable, "feed its watchdog", kGaveWay));
      break;
    }
    Result<void> fed = feed(*drive);
    if (!fed && outcome) outcome = std::move(fed);  // the others are fed all the same
  }
  const std::lock_guard lock(mutex_);
  in_use_ = nullptr;
  is_interrupted_ = false;
  return outcome;
}

void DriveHaltLine::interrupt() {
  const std::lock_guard lock(mutex_);
  is_interrupted_ = true;
  if (in_use_ != nullptr) in_use_->interrupt();
}

}  // namespace gonio::drivers
