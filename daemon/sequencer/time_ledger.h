#pragma once

#include <algorithm>

#include "base/clock.h"

namespace gonio::daemon {

/// Gives each instant of a scan to one account: what was counted once is not counted again, and nothing is left out.
class TimeLedger {
 public:
  void restart(Instant now) { counted_until_ = now; }
  /// All since the last entry.
  void enter(Duration& account, Instant now) { enter(now - counted_until_, account, account, now); }
  /// Of all since the last entry `at_most` into `own`, what is left into `beyond`.
  void enter(Duration at_most, Duration& own, Duration& beyond, Instant now) {
    const Duration all = std::max(now - counted_until_, Duration::zero());
    const Duration part = std::clamp(at_most, Duration::zero(), all);
    own += part;
    beyond += all - part;
    counted_until_ = std::max(counted_until_, now);
  }
  /// The first `at_most` since the last entry; what is left is for the next one.
  void enter_first(Duration at_most, Duration& account, Instant now) {
    const Duration part = std::clamp(at_most, Duration::zero(), std::max(now - counted_until_, Duration::zero()));
    account += part;
    counted_until_ += part;
  }

 private:
  Instant counted_until_{};
};

}  // namespace gonio::daemon
