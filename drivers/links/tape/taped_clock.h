#pragma once

#include "base/clock.h"
#include "drivers/links/tape/tape_sink.h"

namespace gonio::drivers {

/// One party's view of a clock, with every reading recorded: what a driver decides by the time it decides again at the
/// replay. `sink` and `clock` must outlive it. Threads: the party's.
class TapedClock final : public Clock {
 public:
  TapedClock(TapeSink& sink, const Clock& clock, TapeParty party) : sink_(sink), clock_(clock), party_(party) {}

  Instant now() const override {
    const Instant now = clock_.now();
    sink_.put(TapeReading{.party = party_, .is_utc = false, .ns = now.time_since_epoch().count()});
    return now;
  }
  UtcTime utc_now() const override {
    const UtcTime now = clock_.utc_now();
    sink_.put(TapeReading{.party = party_, .is_utc = true, .ns = now.time_since_epoch().count()});
    return now;
  }

 private:
  TapeSink& sink_;
  const Clock& clock_;
  TapeParty party_;
};

}  // namespace gonio::drivers
