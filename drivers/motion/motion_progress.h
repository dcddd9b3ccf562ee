#pragma once

#include "base/clock.h"

namespace gonio::drivers {

/// What one look at a motion that goes well has shown.
struct MotionProgress {
  bool is_done = false;
  Instant next_look{};  ///< when to look again, if it is not done
};

}  // namespace gonio::drivers
