#include "drivers/drive_stage/drive_latch.h"

#include <algorithm>

namespace gonio::drivers {

DriveLatch::Seen DriveLatch::seen() const {
  const std::lock_guard lock(mutex_);
  return seen_;
}

bool DriveLatch::may_move(Epoch epoch) const {
  const std::lock_guard lock(mutex_);
  return !seen_.halted && epoch >= seen_.epoch;
}

void DriveLatch::halt(Epoch epoch) {
  const std::lock_guard lock(mutex_);
  if (!seen_.halted || epoch > seen_.epoch) ++seen_.stop_count;  // a halt that is tried again is the same halt
  seen_.epoch = std::max(seen_.epoch, epoch);
  seen_.halted = true;
}

bool DriveLatch::reset(Epoch epoch) {
  const std::lock_guard lock(mutex_);
  if (epoch < seen_.epoch) return false;
  seen_.halted = false;
  return true;
}

bool DriveLatch::is_in_motion() const {
  const std::lock_guard lock(mutex_);
  return is_in_motion_;
}

void DriveLatch::set_in_motion(bool on) {
  const std::lock_guard lock(mutex_);
  is_in_motion_ = on;
}

}  // namespace gonio::drivers
